// The rename of a file on the same file system is atomic in POSIX; the fsync before it puts the bytes on the disk
// before the name points to them, the fsync of the folder after it makes the new name last.
#include "io/file/atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/parallel.h"

static int system_error(brunt_error *error, const char *what, const char *path) {
    return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot %s: %s", path, what, strerror(errno));
}

int brunt_sync_data(int descriptor, bool all) {
    brunt_parallel_idle(true);
    const int failed = all ? fsync(descriptor) : fdatasync(descriptor);
    const int reason = errno;
    brunt_parallel_idle(false);
    errno = reason;
    return failed;
}

static int sync_folder_of(const char *path, brunt_error *error) {
    char folder[BRUNT_PATH_LENGTH];
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) : 0;
    if (slash == path) {
        strcpy(folder, "/");
    } else if (slash) {
        memcpy(folder, path, length);
        folder[length] = 0;
    } else {
        strcpy(folder, ".");
    }
    int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return system_error(error, "open the folder", folder);
    // Some file systems cannot sync a folder (EINVAL, ENOTSUP): their renames are as lasting as they get.
    int status = brunt_sync_data(descriptor, true) && errno != EINVAL && errno != ENOTSUP ? -1 : 0;
    if (status) system_error(error, "flush the folder", folder);
    close(descriptor);
    return status ? BRUNT_IO_ERROR : BRUNT_OK;
}

int brunt_atomic_open(brunt_atomic_file *file, const char *path, brunt_error *error) {
    file->stream = NULL;
    file->aside[0] = 0;
    size_t length = strlen(path);
    if (length + sizeof ".part" > BRUNT_PATH_LENGTH)
        return brunt_fail(error, BRUNT_IO_ERROR, "%.200s...: the path is longer than %d bytes", path,
                          BRUNT_PATH_LENGTH);
    memcpy(file->path, path, length + 1);
    memcpy(file->aside, path, length);
    strcpy(file->aside + length, ".part");
    // What an earlier writer left there goes; a link of that name is not followed.
    unlink(file->aside);
    int descriptor = open(file->aside, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    file->stream = descriptor < 0 ? NULL : fdopen(descriptor, "w+b");
    if (!file->stream) {
        if (descriptor >= 0) close(descriptor);
        int status = system_error(error, "create the file", file->aside);
        file->aside[0] = 0;
        return status;
    }
    return BRUNT_OK;
}

void brunt_atomic_abandon(brunt_atomic_file *file) {
    if (file->stream) fclose(file->stream);
    file->stream = NULL;
    if (file->aside[0]) unlink(file->aside);
    file->aside[0] = 0;
}

int brunt_atomic_write(brunt_atomic_file *file, const void *data, size_t bytes, brunt_error *error) {
    if (bytes && fwrite(data, 1, bytes, file->stream) != bytes)
        return system_error(error, "write the file", file->path);
    return BRUNT_OK;
}

int brunt_atomic_flush(brunt_atomic_file *file, brunt_error *error) {
    errno = 0;
    // An earlier write may have failed unseen (it left the stream's error flag): flushing again gives its errno again.
    bool failed = ferror(file->stream) != 0;
    failed = fflush(file->stream) != 0 || failed || brunt_sync_data(fileno(file->stream), true) != 0;
    if (failed && errno == 0) errno = EIO;
    if (failed) {
        int status = system_error(error, "write the file", file->path);
        brunt_atomic_abandon(file);
        return status;
    }
    int closed = fclose(file->stream);
    file->stream = NULL;
    if (closed) {
        int status = system_error(error, "close the file", file->path);
        brunt_atomic_abandon(file);
        return status;
    }
    return BRUNT_OK;
}

int brunt_atomic_rename(brunt_atomic_file *file, brunt_error *error) {
    if (rename(file->aside, file->path)) {
        int status = system_error(error, "rename what was written aside to it", file->path);
        brunt_atomic_abandon(file);
        return status;
    }
    file->aside[0] = 0;
    return sync_folder_of(file->path, error);
}

int brunt_atomic_commit(brunt_atomic_file *file, brunt_error *error) {
    int status = brunt_atomic_flush(file, error);
    return status ? status : brunt_atomic_rename(file, error);
}

int brunt_keep_backup(const char *path, const char *backup, brunt_error *error) {
    char aside[BRUNT_PATH_LENGTH];
    if ((size_t)snprintf(aside, sizeof aside, "%s.part", backup) >= sizeof aside)
        return brunt_fail(error, BRUNT_IO_ERROR, "%.200s...: the path is longer than %d bytes", backup,
                          BRUNT_PATH_LENGTH);
    if (!brunt_file_exists(path)) return BRUNT_OK;
    unlink(aside);
    // A second name for the same file costs nothing and leaves no moment without one; a plain rename where links are
    // not known.
    if (link(path, aside) == 0) {
        if (rename(aside, backup) == 0) {
            unlink(aside); // rename of two names of one file does nothing and leaves both
            return BRUNT_OK;
        }
        int status = system_error(error, "replace the file", backup);
        unlink(aside);
        return status;
    }
    if (rename(path, backup)) return system_error(error, "replace the file", backup);
    return BRUNT_OK;
}

int brunt_make_folder(const char *path, brunt_error *error) {
    char part[BRUNT_PATH_LENGTH];
    size_t length = strlen(path);
    if (length == 0 || length >= sizeof part)
        return brunt_fail(error, BRUNT_IO_ERROR,
                          "'%.200s' cannot be the name of a folder: empty or longer than %d bytes", path,
                          BRUNT_PATH_LENGTH);
    memcpy(part, path, length + 1);
    for (size_t i = 1; i <= length; i++) {
        if (part[i] != '/' && part[i] != 0) continue;
        char kept = part[i];
        part[i] = 0;
        if (mkdir(part, 0777) && errno != EEXIST) return system_error(error, "make the folder", part);
        part[i] = kept;
    }
    struct stat info;
    if (stat(path, &info)) return system_error(error, "make the folder", path);
    if (!S_ISDIR(info.st_mode)) {
        errno = ENOTDIR;
        return system_error(error, "write into it", path);
    }
    return BRUNT_OK;
}

int brunt_join_path(char out[BRUNT_PATH_LENGTH], const char *folder, const char *name, brunt_error *error) {
    size_t length = strlen(folder);
    const char *between = length && folder[length - 1] == '/' ? "" : "/";
    if ((size_t)snprintf(out, BRUNT_PATH_LENGTH, "%s%s%s", folder, between, name) < BRUNT_PATH_LENGTH) return BRUNT_OK;
    return brunt_fail(error, BRUNT_IO_ERROR, "%.200s...: the path is longer than %d bytes", folder, BRUNT_PATH_LENGTH);
}

bool brunt_file_exists(const char *path) {
    struct stat info;
    return stat(path, &info) == 0;
}
