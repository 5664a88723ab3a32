#include "io/file/hdf5_file.h"

#include <errno.h>
#include <fcntl.h>
#include <libdeflate.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/error.h"
#include "io/file/input_file.h"
#include "base/memory.h"

// HDF5 prints its error stack unless told otherwise; the library never prints.
static void silence(void) { H5Eset_auto2(H5E_DEFAULT, NULL, NULL); }

// The 1.8 file format: its object headers have checksums, and unlike the later ones it holds no "open for writing"
// flag. Without the times of its objects: the same contents are the same bytes.
static hid_t create(const char *name, hid_t access) {
    hid_t creation = H5Pcreate(H5P_FILE_CREATE), file = -1;
    if (access >= 0 && creation >= 0 && H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0 &&
        H5Pset_userblock(creation, BRUNT_HDF5_USER_BLOCK) >= 0 && H5Pset_obj_track_times(creation, false) >= 0)
        file = H5Fcreate(name, H5F_ACC_TRUNC, creation, access);
    H5Pclose(access);
    H5Pclose(creation);
    return file;
}

hid_t brunt_hdf5_create(size_t bytes_expected) {
    silence();
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    size_t increment = bytes_expected / 4 > 65536 ? bytes_expected / 4 : 65536;
    if (access >= 0 && H5Pset_fapl_core(access, increment, 0) < 0) {
        H5Pclose(access);
        return H5I_INVALID_HID;
    }
    return create("in memory", access);
}

static void print_block(char block[BRUNT_HDF5_USER_BLOCK], const char *kind, int format, size_t length, uint32_t sum) {
    memset(block, 0, BRUNT_HDF5_USER_BLOCK);
    snprintf(block, BRUNT_HDF5_USER_BLOCK,
             "brunt %s, format %d, %zu bytes of HDF5 follow this block of 512, CRC-32 %08lx\n", kind, format, length,
             (unsigned long)sum);
}

int brunt_hdf5_write(hid_t file, const char *kind, int format, const char *path, brunt_atomic_file *out,
                     brunt_error *error) {
    void *handle = NULL;
    hsize_t size = 0;
    // The core driver's handle is the address of its buffer: written from there, no second copy is needed.
    bool ready = H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0 && H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0 &&
                 H5Fget_filesize(file, &size) >= 0 && size > BRUNT_HDF5_USER_BLOCK;
    if (!ready) {
        H5Fclose(file);
        return brunt_fail(error, BRUNT_FAILED, "%s: HDF5 could not put the file together", path);
    }
    const unsigned char *data = *(unsigned char **)handle;
    size_t length = (size_t)size - BRUNT_HDF5_USER_BLOCK;
    char block[BRUNT_HDF5_USER_BLOCK];
    print_block(block, kind, format, length, libdeflate_crc32(0, data + BRUNT_HDF5_USER_BLOCK, length));
    int status = brunt_atomic_open(out, path, error);
    if (!status) {
        status = brunt_atomic_write(out, block, sizeof block, error);
        if (!status) status = brunt_atomic_write(out, data + BRUNT_HDF5_USER_BLOCK, length, error);
        if (status)
            brunt_atomic_abandon(out);
        else
            status = brunt_atomic_flush(out, error);
    }
    H5Fclose(file);
    return status;
}

// Room for a file that HDF5 writes itself, so that it does not meet a full disk. Some file systems keep none; errno.
static bool reserve_disk(int descriptor, size_t bytes) {
    struct rlimit limit;
    if (!getrlimit(RLIMIT_FSIZE, &limit) && limit.rlim_cur != RLIM_INFINITY && bytes > limit.rlim_cur) {
        errno = EFBIG;
        return false;
    }
    return !fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes) ||
           (errno != ENOSPC && errno != EDQUOT && errno != EFBIG);
}

int brunt_hdf5_create_aside(const char *path, size_t bytes, brunt_atomic_file *out, hid_t *file, brunt_error *error) {
    silence();
    int status = brunt_atomic_open(out, path, error);
    if (status) return status;
    *file = create(out->aside, H5Pcreate(H5P_FILE_ACCESS));
    if (*file >= 0 && reserve_disk(fileno(out->stream), bytes)) return BRUNT_OK;
    status = brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", path,
                        *file < 0 ? "HDF5 could not start it" : strerror(errno));
    if (*file >= 0) H5Fclose(*file);
    brunt_atomic_abandon(out);
    return status;
}

// The user block of a file that is there but for it.
static int put_block(const char *kind, int format, brunt_atomic_file *out, brunt_error *error) {
    enum { PIECE = 1 << 20 };
    unsigned char *piece = brunt_alloc(PIECE);
    if (!piece) return brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", out->path);
    const int descriptor = fileno(out->stream);
    size_t length = 0;
    uint32_t sum = 0;
    ssize_t got;
    while ((got = pread(descriptor, piece, PIECE, (off_t)(BRUNT_HDF5_USER_BLOCK + length))) > 0) {
        sum = libdeflate_crc32(sum, piece, (size_t)got);
        length += (size_t)got;
    }
    brunt_free(piece);
    char block[BRUNT_HDF5_USER_BLOCK];
    print_block(block, kind, format, length, sum);
    if (got == 0 && pwrite(descriptor, block, sizeof block, 0) == (ssize_t)sizeof block) return BRUNT_OK;
    return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot write the file: %s", out->path, strerror(errno));
}

int brunt_hdf5_seal(hid_t file, const char *kind, int format, int status, brunt_atomic_file *out, brunt_error *error) {
    if (H5Fclose(file) < 0 && !status)
        status = brunt_fail(error, BRUNT_IO_ERROR, "%s: HDF5 could not write the file", out->path);
    if (!status) status = put_block(kind, format, out, error);
    if (!status) return brunt_atomic_flush(out, error);
    brunt_atomic_abandon(out);
    return status;
}

static bool parse_block(FILE *stream, char kind[32], int *format, size_t *length, unsigned long *sum) {
    char block[BRUNT_HDF5_USER_BLOCK + 1] = {0};
    if (fread(block, 1, BRUNT_HDF5_USER_BLOCK, stream) != BRUNT_HDF5_USER_BLOCK) return false;
    return sscanf(block, "brunt %31[a-z], format %d, %zu bytes of HDF5 follow this block of 512, CRC-32 %8lx", kind,
                  format, length, sum) == 4;
}

bool brunt_hdf5_kind(const char *path, char kind[32], int *format) {
    const char *why;
    FILE *stream = brunt_input_open(path, &why);
    if (!stream) return false;
    size_t length;
    unsigned long sum;
    bool ours = parse_block(stream, kind, format, &length, &sum);
    fclose(stream);
    return ours;
}

static int verify(FILE *stream, const char *path, const char *kind, int format, brunt_error *error) {
    char found[32];
    int found_format;
    size_t length, got = 0;
    unsigned long wanted;
    uint32_t sum = 0;
    if (!parse_block(stream, found, &found_format, &length, &wanted))
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: not a brunt %s, or its beginning is damaged", path, kind);
    if (strcmp(found, kind))
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: this is a brunt %s, a %s is wanted", path, found, kind);
    if (found_format != format)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: the file has format %d, this program reads format %d", path,
                          found_format, format);
    enum { PIECE = 1 << 20 };
    unsigned char *piece = brunt_alloc(PIECE);
    if (!piece) return brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s", path);
    for (size_t n; (n = fread(piece, 1, PIECE, stream)) > 0; got += n) sum = libdeflate_crc32(sum, piece, n);
    brunt_free(piece);
    if (ferror(stream)) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot read the file: %s", path, strerror(errno));
    if (got < length)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: the file is cut short: %zu of its %zu bytes are there", path,
                          got + BRUNT_HDF5_USER_BLOCK, length + BRUNT_HDF5_USER_BLOCK);
    if (got > length || sum != wanted)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: the file is damaged: its checksum does not fit its contents",
                          path);
    return BRUNT_OK;
}

int brunt_hdf5_open(const char *path, const char *kind, int format, hid_t *file, brunt_error *error) {
    silence();
    *file = -1;
    const char *why;
    FILE *stream = brunt_input_open(path, &why);
    if (!stream) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", path, why);
    int status = verify(stream, path, kind, format, error);
    fclose(stream);
    if (status) return status;
    *file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (*file < 0) return brunt_fail(error, BRUNT_BAD_INPUT, "%s: HDF5 cannot read the file", path);
    return BRUNT_OK;
}

void brunt_hdf5_maker_start(brunt_hdf5_maker *m, hid_t file) {
    *m = (brunt_hdf5_maker){.file = file, .folder = H5I_INVALID_HID};
    m->groups = H5Pcreate(H5P_GROUP_CREATE), m->sets = H5Pcreate(H5P_DATASET_CREATE);
    m->ready = m->groups >= 0 && m->sets >= 0 && H5Pset_obj_track_times(m->groups, false) >= 0 &&
               H5Pset_fletcher32(m->sets) >= 0 && H5Pset_obj_track_times(m->sets, false) >= 0;
}

static void leave_folder(brunt_hdf5_maker *m) {
    if (m->folder >= 0) H5Gclose(m->folder);
    m->folder = H5I_INVALID_HID;
}

void brunt_hdf5_maker_end(brunt_hdf5_maker *m) {
    leave_folder(m);
    if (m->groups >= 0) H5Pclose(m->groups);
    if (m->sets >= 0) H5Pclose(m->sets);
}

// Makes the folders of a name that are not there yet, the last of which is the maker's then.
static bool enter_folder(brunt_hdf5_maker *m, const char *name, size_t length) {
    bool ok = length < sizeof m->path;
    leave_folder(m);
    for (size_t at = 1; at <= length && ok; at++) {
        if (name[at] != '/') continue;
        memcpy(m->path, name, at);
        m->path[at] = 0;
        leave_folder(m);
        m->folder = H5Lexists(m->file, m->path, H5P_DEFAULT) > 0
                        ? H5Gopen2(m->file, m->path, H5P_DEFAULT)
                        : H5Gcreate2(m->file, m->path, H5P_DEFAULT, m->groups, H5P_DEFAULT);
        ok = m->folder >= 0;
    }
    return ok;
}

hid_t brunt_hdf5_make(brunt_hdf5_maker *m, const char *name, hid_t file_type, hsize_t count, hsize_t chunk) {
    const hsize_t unlimited = H5S_UNLIMITED;
    const size_t folder = (size_t)(strrchr(name, '/') - name);
    const bool here = folder == 0 || (m->folder >= 0 && strlen(m->path) == folder && !strncmp(m->path, name, folder));
    if (!m->ready || H5Pset_chunk(m->sets, 1, &chunk) < 0 || (!here && !enter_folder(m, name, folder)))
        return H5I_INVALID_HID;
    const hid_t space = H5Screate_simple(1, &count, &unlimited);
    if (space < 0) return H5I_INVALID_HID;
    const hid_t set = H5Dcreate2(folder ? m->folder : m->file, name + folder + 1, file_type, space, H5P_DEFAULT,
                                 m->sets, H5P_DEFAULT);
    H5Sclose(space);
    return set;
}

bool brunt_hdf5_put(brunt_hdf5_maker *m, const char *name, hid_t file_type, hid_t memory_type, hsize_t count,
                    const void *values) {
    hsize_t size = H5Tget_size(file_type), chunk = (1u << 20) / (size ? size : 1);
    if (chunk > count) chunk = count ? count : 1;
    hid_t set = brunt_hdf5_make(m, name, file_type, count, chunk);
    bool ok = set >= 0 && (count == 0 || H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    if (set >= 0) H5Dclose(set);
    return ok;
}

// Whether the name leads to its object by hard links alone, that is, within the file.
static bool stays_within(hid_t file, const char *name) {
    char part[256];
    size_t length = strlen(name);
    if (length >= sizeof part) return false;
    for (size_t at = 1; at <= length; at++) {
        if (name[at] && name[at] != '/') continue;
        H5L_info_t info;
        memcpy(part, name, at);
        part[at] = 0;
        if (H5Lget_info(file, part, &info, H5P_DEFAULT) < 0 || info.type != H5L_TYPE_HARD) return false;
    }
    return true;
}

// No data outside of the file, no filter but the checksum: values take as many bytes in the file as in memory.
static bool is_plain(hid_t set) {
    hid_t creation = H5Dget_create_plist(set);
    if (creation < 0) return false;
    const H5D_layout_t layout = H5Pget_layout(creation);
    bool plain = (layout == H5D_CHUNKED || layout == H5D_CONTIGUOUS || layout == H5D_COMPACT) &&
                 H5Pget_external_count(creation) == 0;
    const int filters = H5Pget_nfilters(creation);
    for (int f = 0; f < filters && plain; f++) {
        unsigned flags, config;
        size_t none = 0;
        plain = H5Pget_filter2(creation, (unsigned)f, &flags, &none, NULL, 0, NULL, &config) == H5Z_FILTER_FLETCHER32;
    }
    H5Pclose(creation);
    return plain && filters >= 0;
}

static int64_t count_of(hid_t file, hid_t set, H5T_class_t kind, size_t bytes) {
    hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    hsize_t count = 0, size = 0;
    bool good = type >= 0 && space >= 0 && H5Tget_class(type) == kind && H5Tget_size(type) == bytes &&
                H5Sget_simple_extent_ndims(space) == 1 && H5Sget_simple_extent_dims(space, &count, NULL) == 1 &&
                H5Fget_filesize(file, &size) >= 0 && count <= size / bytes;
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    return good ? (int64_t)count : BRUNT_NONE;
}

hid_t brunt_hdf5_dataset(hid_t file, const char *name, H5T_class_t kind, size_t bytes, int64_t *count) {
    *count = -1;
    H5O_info_t info;
    if (!stays_within(file, name) || H5Oget_info_by_name2(file, name, &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0 ||
        info.type != H5O_TYPE_DATASET)
        return H5I_INVALID_HID;
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    if (set < 0) return H5I_INVALID_HID;
    if (is_plain(set)) *count = count_of(file, set, kind, bytes);
    if (*count >= 0) return set;
    H5Dclose(set);
    return H5I_INVALID_HID;
}

// Reads into `values`, or writes `source`.
static bool move_part(hid_t set, hid_t memory_type, int64_t first, int64_t count, void *values, const void *source) {
    hsize_t start = (hsize_t)first, length = (hsize_t)count;
    if (!count) return true;
    hid_t there = H5Dget_space(set), here = H5Screate_simple(1, &length, NULL);
    bool ok = there >= 0 && here >= 0 && H5Sselect_hyperslab(there, H5S_SELECT_SET, &start, NULL, &length, NULL) >= 0 &&
              (source ? H5Dwrite(set, memory_type, here, there, H5P_DEFAULT, source)
                      : H5Dread(set, memory_type, here, there, H5P_DEFAULT, values)) >= 0;
    if (here >= 0) H5Sclose(here);
    if (there >= 0) H5Sclose(there);
    return ok;
}

bool brunt_hdf5_read(hid_t set, hid_t memory_type, int64_t first, int64_t count, void *values) {
    return move_part(set, memory_type, first, count, values, NULL);
}

bool brunt_hdf5_write_part(hid_t set, hid_t memory_type, int64_t first, int64_t count, const void *values) {
    return move_part(set, memory_type, first, count, NULL, values);
}

void brunt_hdf5_printable(char *text) {
    for (; *text; text++)
        if ((unsigned char)*text < ' ' || *text == 127) *text = '?';
}

static bool put_attribute(hid_t object, const char *name, hid_t file_type, hid_t memory_type, const void *value) {
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
    bool ok = attribute >= 0 && H5Awrite(attribute, memory_type, value) >= 0;
    if (attribute >= 0) H5Aclose(attribute);
    if (space >= 0) H5Sclose(space);
    return ok;
}

bool brunt_hdf5_put_text(hid_t object, const char *attribute, const char *text) {
    hid_t type = H5Tcopy(H5T_C_S1);
    bool ok =
        type >= 0 && H5Tset_size(type, strlen(text) + 1) >= 0 && put_attribute(object, attribute, type, type, text);
    if (type >= 0) H5Tclose(type);
    return ok;
}

bool brunt_hdf5_put_number(hid_t object, const char *attribute, double value) {
    return put_attribute(object, attribute, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

bool brunt_hdf5_put_integer(hid_t object, const char *attribute, long long value) {
    return put_attribute(object, attribute, H5T_STD_I64LE, H5T_NATIVE_LLONG, &value);
}

static bool get_attribute(hid_t object, const char *name, H5T_class_t kind, hid_t memory_type, void *value) {
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    hid_t type = attribute >= 0 ? H5Aget_type(attribute) : -1, space = attribute >= 0 ? H5Aget_space(attribute) : -1;
    bool ok = type >= 0 && space >= 0 && H5Tget_class(type) == kind && H5Sget_simple_extent_npoints(space) == 1 &&
              H5Tis_variable_str(type) <= 0 && H5Aread(attribute, memory_type, value) >= 0;
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    if (attribute >= 0) H5Aclose(attribute);
    return ok;
}

bool brunt_hdf5_get_text(hid_t object, const char *attribute, char *text, size_t room) {
    hid_t type = H5Tcopy(H5T_C_S1);
    bool ok = type >= 0 && H5Tset_size(type, room) >= 0 && get_attribute(object, attribute, H5T_STRING, type, text);
    text[ok ? room - 1 : 0] = 0;
    if (type >= 0) H5Tclose(type);
    brunt_hdf5_printable(text);
    return ok;
}

bool brunt_hdf5_get_number(hid_t object, const char *attribute, double *value) {
    return get_attribute(object, attribute, H5T_FLOAT, H5T_NATIVE_DOUBLE, value);
}

bool brunt_hdf5_get_integer(hid_t object, const char *attribute, long long *value) {
    return get_attribute(object, attribute, H5T_INTEGER, H5T_NATIVE_LLONG, value);
}
