#include "io/file/input_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

FILE *brunt_input_open(const char *path, const char **why) {
    struct stat info;
    int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    *why = file < 0 ? strerror(errno) : NULL;
    if (file >= 0 && fstat(file, &info)) *why = strerror(errno);
    if (!*why && !S_ISREG(info.st_mode))
        *why = S_ISDIR(info.st_mode) ? "not a file, but a folder" : "not a file, but a pipe or a device";
    FILE *stream = *why ? NULL : fdopen(file, "rb");
    if (!stream && !*why) *why = strerror(errno);
    if (!stream && file >= 0) close(file);
    return stream;
}
