#include "io/file/output_folder.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"

enum { NAME_MAX_BYTES = 255 };

static const char list_name[] = BRUNT_OUTPUT_LIST,
                  heading[] = "# What brunt wrote into this folder, and may replace or remove; anything else stays.\n";

static int system_error(const brunt_output_folder *out, const char *name, const char *what, brunt_error *error) {
    return brunt_fail(error, BRUNT_IO_ERROR, "%s/%s: cannot %s: %s", out->path, name, what, strerror(errno));
}

// ---------------------------------------------------------------------------------------------------- the list

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

bool brunt_output_listed(const brunt_output_folder *out, const char *name) {
    return out->count && bsearch(&name, out->names, (size_t)out->count, sizeof *out->names, by_name);
}

// Names stay below the folder: no list can make brunt remove something elsewhere.
static bool stays_below(const char *name) {
    if (!*name || *name == '/') return false;
    for (const char *part = name; part; part = strchr(part, '/'), part = part ? part + 1 : NULL) {
        size_t length = strcspn(part, "/");
        if (length <= 2 && !strncmp(part, "..", length) && length) return false;
    }
    return true;
}

static void forget_names(brunt_output_folder *out) {
    brunt_free(out->text);
    brunt_free(out->names);
    out->text = NULL, out->names = NULL, out->count = 0;
}

// Takes over the lines in `text`, which becomes the folder's. A last one without an end was cut off by a kill.
static int take_names(brunt_output_folder *out, char *text, brunt_error *error) {
    int32_t lines = 0;
    forget_names(out);
    out->text = text;
    for (const char *at = text; (at = strchr(at, '\n')); at++) lines++;
    out->names = brunt_alloc(sizeof *out->names * (size_t)lines);
    if (!out->names) return brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s/%s", out->path, list_name);
    for (char *at = text, *end; (end = strchr(at, '\n')); at = end + 1) {
        *end = 0;
        if (*at == '#') continue;
        if (!stays_below(at))
            return brunt_fail(error, BRUNT_BAD_INPUT, "%s/%s: '%.200s' is no name within the folder", out->path,
                              list_name, at);
        out->names[out->count++] = at;
    }
    qsort(out->names, (size_t)out->count, sizeof *out->names, by_name);
    return BRUNT_OK;
}

static int read_list(brunt_output_folder *out, brunt_error *error) {
    struct stat info;
    if (fstat(out->index, &info)) return system_error(out, list_name, "read the file", error);
    char *text = brunt_alloc((size_t)info.st_size + 1); // zeroed: ends with 0
    if (!text) return brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s/%s", out->path, list_name);
    size_t used = 0;
    for (ssize_t got = 1; got > 0 && used < (size_t)info.st_size; used += (size_t)(got > 0 ? got : 0))
        got = pread(out->index, text + used, (size_t)info.st_size - used, (off_t)used);
    if (used && strncmp(text, heading, sizeof heading - 1) != 0) {
        brunt_free(text);
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s/%s: no list of brunt's; another folder is wanted (-o)", out->path,
                          list_name);
    }
    return take_names(out, text, error);
}

static int lock_list(brunt_output_folder *out, brunt_error *error) {
    if (flock(out->index, LOCK_EX | LOCK_NB) == 0) return BRUNT_OK;
    if (errno != EWOULDBLOCK) return system_error(out, list_name, "lock the file", error);
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "%s: another run is writing into this folder; wait for its end, or choose "
                      "another one (-o)",
                      out->path);
}

int brunt_output_open(brunt_output_folder *out, const char *path, brunt_error *error) {
    *out = (brunt_output_folder){.folder = -1, .index = -1};
    int status = brunt_join_path(out->path, path, "", error);
    size_t length = strlen(out->path);
    if (length > 1 && out->path[length - 1] == '/') out->path[length - 1] = 0;
    if (status) return status;
    out->folder = open(out->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (out->folder < 0 && errno == ENOENT) return BRUNT_OK;
    if (out->folder < 0)
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the folder: %s", out->path, strerror(errno));
    out->index = openat(out->folder, list_name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (out->index < 0 && errno == ENOENT) return BRUNT_OK;
    struct stat info;
    const bool link = out->index < 0 && errno == ELOOP;
    if (out->index < 0 && !link) status = system_error(out, list_name, "open the file", error);
    if (link || (!status && (fstat(out->index, &info) || !S_ISREG(info.st_mode))))
        status =
            brunt_fail(error, BRUNT_BAD_INPUT, "%s/%s: no file; another folder is wanted (-o)", out->path, list_name);
    if (!status) status = lock_list(out, error);
    return status ? status : read_list(out, error);
}

int brunt_output_path(const brunt_output_folder *out, const char *name, char path[BRUNT_PATH_LENGTH],
                      brunt_error *error) {
    struct stat own, there;
    if (out->folder >= 0 && !fstat(out->folder, &own) &&
        (stat(out->path, &there) || there.st_dev != own.st_dev || there.st_ino != own.st_ino))
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: was moved or removed while brunt was at work there", out->path);
    return brunt_join_path(path, out->path, name, error);
}

void brunt_output_close(brunt_output_folder *out) {
    forget_names(out);
    if (out->index >= 0) close(out->index);
    if (out->folder >= 0) close(out->folder);
    out->index = out->folder = -1;
}

// ---------------------------------------------------------------------------------------------------- below the folder

// The folder that `name` lies in, to be closed; `*leaf` is what it is called there. Negative when there is none, or a
// link leads to it.
static int open_parent(const brunt_output_folder *out, const char *name, const char **leaf) {
    int at = out->folder < 0 ? -1 : fcntl(out->folder, F_DUPFD_CLOEXEC, 0);
    for (const char *slash; at >= 0 && (slash = strchr(name, '/')) && slash[1]; name = slash + 1) {
        char part[NAME_MAX_BYTES + 1];
        const size_t length = (size_t)(slash - name);
        int next = -1;
        if (length <= NAME_MAX_BYTES) {
            memcpy(part, name, length);
            part[length] = 0;
            next = openat(at, part, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        }
        close(at);
        at = next;
    }
    *leaf = name;
    return at;
}

// Of what itself stands there, not of what it leads to. `extra` is appended to the name.
static bool look_at(const brunt_output_folder *out, const char *name, const char *extra, struct stat *info) {
    const char *leaf;
    char whole[NAME_MAX_BYTES + 1];
    int parent = open_parent(out, name, &leaf);
    if (parent < 0) return false;
    size_t length = strcspn(leaf, "/");
    snprintf(whole, sizeof whole, "%.*s%s", (int)length, leaf, extra);
    bool there = fstatat(parent, whole, info, AT_SYMLINK_NOFOLLOW) == 0;
    close(parent);
    return there;
}

bool brunt_output_has(const brunt_output_folder *out, const char *name) {
    struct stat info;
    return look_at(out, name, "", &info);
}

static int remove_below(const brunt_output_folder *out, const char *name, const char *extra) {
    const char *leaf;
    char whole[NAME_MAX_BYTES + 1];
    int parent = open_parent(out, name, &leaf);
    if (parent < 0) return 0;
    size_t length = strcspn(leaf, "/");
    snprintf(whole, sizeof whole, "%.*s%s", (int)length, leaf, extra);
    int failed = unlinkat(parent, whole, leaf[length] ? AT_REMOVEDIR : 0);
    if (failed && (errno == ENOENT || errno == ENOTDIR || (leaf[length] && (errno == ENOTEMPTY || errno == EEXIST))))
        failed = 0;
    close(parent);
    return failed;
}

// ---------------------------------------------------------------------------------------------------- obstacles

static void add_obstacle(brunt_obstacles *found, const char *name, const char *extra) {
    size_t used = strlen(found->names), room = sizeof found->names - used;
    int wanted = snprintf(NULL, 0, "%s%s%s", found->count ? ", " : "", name, extra);
    if ((size_t)wanted < room) snprintf(found->names + used, room, "%s%s%s", found->count ? ", " : "", name, extra);
    found->count++;
}

void brunt_output_obstacle(const brunt_output_folder *out, const char *name, brunt_obstacles *found) {
    struct stat info;
    const bool folder = name[strlen(name) - 1] == '/', listed = brunt_output_listed(out, name);
    if (look_at(out, name, "", &info) && (folder ? !S_ISDIR(info.st_mode) : !listed || !S_ISREG(info.st_mode)))
        add_obstacle(found, name, "");
    if (!folder && look_at(out, name, ".part", &info) && (!listed || !S_ISREG(info.st_mode)))
        add_obstacle(found, name, ".part");
}

// Whether `entry` is one of the names with a number: "NAME_000.vtu".
static bool is_numbered(const char *entry, size_t length, const brunt_names *names, const char *ending) {
    const size_t end = strlen(ending);
    if (length <= end || strncmp(entry + length - end, ending, end) != 0) return false;
    length -= end;
    const size_t before = length;
    while (length && isdigit((unsigned char)entry[length - 1])) length--;
    return length < before && length > 1 && entry[length - 1] == '_' &&
           brunt_names_find(names, entry, length - 1) != BRUNT_NONE;
}

void brunt_output_numbered_obstacles(const brunt_output_folder *out, const char *name, const brunt_names *names,
                                     const char *ending, brunt_obstacles *found) {
    char path[2 * NAME_MAX_BYTES + 2];
    int folder = out->folder < 0 ? -1 : openat(out->folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    DIR *directory = folder < 0 ? NULL : fdopendir(folder);
    if (!directory) return; // a link: an obstacle of its own
    for (struct dirent *entry; (entry = readdir(directory));) {
        size_t length = strlen(entry->d_name);
        if (length > 5 && !strcmp(entry->d_name + length - 5, ".part")) length -= 5;
        if (!is_numbered(entry->d_name, length, names, ending)) continue;
        snprintf(path, sizeof path, "%.100s/%.*s", name, (int)length, entry->d_name);
        struct stat info;
        const bool file = look_at(out, path, entry->d_name[length] ? ".part" : "", &info) && S_ISREG(info.st_mode);
        if (!file || !brunt_output_listed(out, path)) add_obstacle(found, path, entry->d_name + length);
    }
    closedir(directory);
}

int brunt_output_refuse(const brunt_output_folder *out, const brunt_obstacles *found, brunt_error *error) {
    if (!found->count) return BRUNT_OK;
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "%s: in the way of the output, and not written by brunt (%s does not list it): %s%s; nothing was "
                      "touched: move it away, or choose another folder (-o)",
                      out->path, list_name, found->names, strlen(found->names) > 500 ? ", ..." : "");
}

// ---------------------------------------------------------------------------------------------------- writing

static int append(brunt_output_folder *out, const char *text, size_t length, brunt_error *error) {
    if (lseek(out->index, 0, SEEK_END) < 0) return system_error(out, list_name, "write the file", error);
    errno = ENOSPC; // of a write that is cut short
    if (write(out->index, text, length) != (ssize_t)length || brunt_sync_data(out->index, false))
        return system_error(out, list_name, "write the file", error);
    return BRUNT_OK;
}

int brunt_output_make(brunt_output_folder *out, brunt_error *error) {
    int status = brunt_make_folder(out->path, error);
    if (status) return status;
    if (out->folder < 0) out->folder = open(out->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (out->folder < 0)
        return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the folder: %s", out->path, strerror(errno));
    struct stat info;
    if (out->index < 0) {
        out->index = openat(out->folder, list_name, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (out->index < 0) return system_error(out, list_name, "create the file", error);
        status = lock_list(out, error);
        if (status) return status;
        if (fstat(out->index, &info) == 0 && info.st_size)
            return brunt_fail(error, BRUNT_BAD_INPUT, "%s: another run has just begun in this folder", out->path);
    }
    if (fstat(out->index, &info)) return system_error(out, list_name, "read the file", error);
    if (!info.st_size) {
        status = append(out, heading, sizeof heading - 1, error);
        if (!status) fsync(out->folder);
        return status;
    }
    // A name that was cut off by a kill ends here, so that the next one is a line of its own.
    char last = 0;
    if (pread(out->index, &last, 1, info.st_size - 1) == 1 && last != '\n') return append(out, "\n", 1, error);
    return BRUNT_OK;
}

// A text of a line each for what is not listed yet. NULL: out of memory.
static char *lines_of(const brunt_output_folder *out, const char *const *names, int32_t count, bool all,
                      size_t *length) {
    char *text = NULL;
    FILE *stream = open_memstream(&text, length);
    if (!stream) return NULL;
    for (int32_t n = 0; n < count; n++)
        if (all || !brunt_output_listed(out, names[n])) fprintf(stream, "%s\n", names[n]);
    if (fclose(stream)) {
        free(text);
        return NULL;
    }
    return text;
}

int brunt_output_list(brunt_output_folder *out, const char *const *names, int32_t count, brunt_error *error) {
    size_t length;
    char *text = lines_of(out, names, count, false, &length);
    if (!text) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    int status = length ? append(out, text, length, error) : BRUNT_OK;
    free(text);
    return status;
}

static bool is_among(const char *name, const char *const *names, int32_t count) {
    for (int32_t n = 0; n < count; n++)
        if (!strcmp(name, names[n])) return true;
    return false;
}

void brunt_output_remove_leftovers(const brunt_output_folder *out) {
    for (int32_t n = 0; n < out->count; n++)
        if (out->names[n][strlen(out->names[n]) - 1] != '/') remove_below(out, out->names[n], ".part");
}

int brunt_output_clear(brunt_output_folder *out, const char *const *keep, int32_t count, brunt_error *error) {
    if (out->index < 0) return BRUNT_OK;
    brunt_output_remove_leftovers(out);
    for (int32_t n = out->count; n-- > 0;) // what lies in a folder comes after its name
        if (!is_among(out->names[n], keep, count) && remove_below(out, out->names[n], ""))
            return system_error(out, out->names[n], "remove the file", error);
    size_t length, head = sizeof heading - 1;
    char *lines = lines_of(out, keep, count, true, &length), *text = lines ? brunt_alloc(head + length + 1) : NULL;
    int status = text ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (text) {
        memcpy(text, heading, head);
        memcpy(text + head, lines, length);
        errno = ENOSPC;
        // Over the beginning first: at no moment are files without a list.
        if (pwrite(out->index, text, head + length, 0) != (ssize_t)(head + length) ||
            ftruncate(out->index, (off_t)(head + length)) || fdatasync(out->index))
            status = system_error(out, list_name, "write the file", error);
    }
    free(lines);
    if (status || take_names(out, text, error)) {
        if (status) brunt_free(text);
        return status ? status : BRUNT_FAILED;
    }
    return BRUNT_OK;
}

int brunt_output_remove(brunt_output_folder *out, brunt_error *error) {
    int status = brunt_output_clear(out, NULL, 0, error);
    if (!status && out->index >= 0) unlinkat(out->folder, list_name, 0);
    if (!status) rmdir(out->path); // stays with what else is in it
    return status;
}

FILE *brunt_output_stream(const brunt_output_folder *out, const char *name, bool anew, brunt_error *error) {
    if (anew) unlinkat(out->folder, name, 0);
    const int mode = O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC | (anew ? O_EXCL : O_NONBLOCK);
    int file = openat(out->folder, name, mode, 0666);
    FILE *stream = file < 0 ? NULL : fdopen(file, "a");
    if (stream) return stream;
    system_error(out, name, "open the file", error);
    if (file >= 0) close(file);
    return NULL;
}
