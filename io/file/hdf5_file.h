// HDF5 files that are whole or not there, and whose damage is found before HDF5 looks at them.
//
// A file is built in memory by HDF5's core driver and then written by brunt_atomic_file: HDF5 itself never meets a full
// disk (a failed close leaves it in a state it cannot leave). In front of the HDF5 data lies a user block of 512 bytes
// with one line of text: what the file is, its format, the number of bytes after the block and their CRC-32. HDF5's own
// tools skip it.
#pragma once

#include <hdf5.h>

#include "io/file/atomic_file.h"

enum { BRUNT_HDF5_USER_BLOCK = 512 };

// Starts a file in memory; `bytes_expected` sets how much it grows at a time. Negative on failure.
hid_t brunt_hdf5_create(size_t bytes_expected);
// Flushes `file`, closes it whatever happens, and writes it to the name aside of `path` (brunt_atomic_rename makes it
// final). `kind`: "checkpoint" or "history".
int brunt_hdf5_write(hid_t file, const char *kind, int format, const char *path, brunt_atomic_file *out,
                     brunt_error *error);

// For what is too large to be in memory: a file made aside of `path`, for which the disk has `bytes` left, and its
// sealing, which closes it, writes the user block and flushes it. With a `status` that is not BRUNT_OK it is abandoned,
// and that returned.
int brunt_hdf5_create_aside(const char *path, size_t bytes, brunt_atomic_file *out, hid_t *file, brunt_error *error);
int brunt_hdf5_seal(hid_t file, const char *kind, int format, int status, brunt_atomic_file *out, brunt_error *error);

// Verifies the user block and the CRC, then opens for reading. BRUNT_IO_ERROR: cannot be read; BRUNT_BAD_INPUT: of
// another kind or format, cut short or damaged.
int brunt_hdf5_open(const char *path, const char *kind, int format, hid_t *file, brunt_error *error);
// Kind of a file by its user block into `kind`; false when it is none of ours.
bool brunt_hdf5_kind(const char *path, char kind[32], int *format);

// Makes the datasets of a file, and stays in the folder of the last one, to which most of the next belong: from the
// root on each takes as long to find as to make.
typedef struct brunt_hdf5_maker {
    hid_t file, folder, groups, sets; // folder: negative, in none; groups, sets: how they are made
    char path[256];                   // of the folder
    bool ready;
} brunt_hdf5_maker;
void brunt_hdf5_maker_start(brunt_hdf5_maker *maker, hid_t file);
void brunt_hdf5_maker_end(brunt_hdf5_maker *maker); // before the file is closed

// One-dimensional datasets, chunked, with a Fletcher-32 checksum, extendible; `name` begins with a slash and may hold
// folders, which are made. True on success.
bool brunt_hdf5_put(brunt_hdf5_maker *maker, const char *name, hid_t file_type, hid_t memory_type, hsize_t count,
                    const void *values);
// Makes a dataset for `put`'s kind of values, to be written in parts. Negative on failure.
hid_t brunt_hdf5_make(brunt_hdf5_maker *maker, const char *name, hid_t file_type, hsize_t count, hsize_t chunk);
bool brunt_hdf5_write_part(hid_t set, hid_t memory_type, int64_t first, int64_t count, const void *values);
// A dataset as `put` writes them, of `count` numbers of that class and size; -1 for anything else: what is not there,
// links to elsewhere, other ranks, types and filters, data outside of the file, or more numbers than the file has room
// for.
hid_t brunt_hdf5_dataset(hid_t file, const char *name, H5T_class_t kind, size_t bytes, int64_t *count);
// The numbers [first, first + count) of such a dataset.
bool brunt_hdf5_read(hid_t set, hid_t memory_type, int64_t first, int64_t count, void *values);
// For a terminal: what is no printable character becomes '?'.
void brunt_hdf5_printable(char *text);
bool brunt_hdf5_put_text(hid_t object, const char *attribute, const char *text);
bool brunt_hdf5_put_number(hid_t object, const char *attribute, double value);
bool brunt_hdf5_put_integer(hid_t object, const char *attribute, long long value);
bool brunt_hdf5_get_text(hid_t object, const char *attribute, char *text, size_t room);
bool brunt_hdf5_get_number(hid_t object, const char *attribute, double *value);
bool brunt_hdf5_get_integer(hid_t object, const char *attribute, long long *value);
