// Files that are whole or not there: written aside in the same folder, flushed to the disk, then renamed over the old
// one.
//
// A full disk, a kill or a power cut at any moment leaves either the old file or the new one, never half of either.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "brunt.h"

enum { BRUNT_PATH_LENGTH = 4096 };

typedef struct brunt_atomic_file {
    FILE *stream;                  // write to it freely: errors stick and are found by the commit
    char path[BRUNT_PATH_LENGTH];  // final name
    char aside[BRUNT_PATH_LENGTH]; // name while it is being written: path + ".part"
} brunt_atomic_file;

// All functions return BRUNT_OK, or BRUNT_IO_ERROR with the path and the system's reason.
int brunt_atomic_open(brunt_atomic_file *file, const char *path, brunt_error *error);
int brunt_atomic_write(brunt_atomic_file *file, const void *data, size_t bytes, brunt_error *error);
// Flush, fsync, rename, fsync of the folder. Whatever the outcome the file is closed and nothing is left aside.
int brunt_atomic_commit(brunt_atomic_file *file, brunt_error *error);
// The two halves of a commit, for a file whose predecessor is to be kept: all is on the disk under the name aside, then
// renamed.
int brunt_atomic_flush(brunt_atomic_file *file, brunt_error *error);
int brunt_atomic_rename(brunt_atomic_file *file, brunt_error *error);
// Closes and removes what was written aside.
void brunt_atomic_abandon(brunt_atomic_file *file);

// Keeps `path` under the name `backup` as well (which is replaced), so that `path` exists all the time. No file at
// `path` is no error.
int brunt_keep_backup(const char *path, const char *backup, brunt_error *error);

// fsync, or without `all` fdatasync: what it says. A thread at work beside the steps lends them its own meanwhile.
int brunt_sync_data(int descriptor, bool all);

// Makes a folder and those above it.
int brunt_make_folder(const char *path, brunt_error *error);
// "folder/name" into `out`; BRUNT_IO_ERROR when it is longer than BRUNT_PATH_LENGTH.
int brunt_join_path(char out[BRUNT_PATH_LENGTH], const char *folder, const char *name, brunt_error *error);
bool brunt_file_exists(const char *path);
