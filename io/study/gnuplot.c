// gnuplot, as a process of its own.
#include "io/study/gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "io/file/atomic_file.h"

extern char **environ;

int gnuplot_remove_file(const char *folder, const char *name, const char *ending, brunt_error *error) {
    char path[BRUNT_PATH_LENGTH], file[176];
    snprintf(file, sizeof file, "%s%s", name, ending);
    int status = brunt_join_path(path, folder, file, error);
    if (!status && unlink(path) && errno != ENOENT)
        status =
            brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot remove what was there before: %s", path, strerror(errno));
    return status;
}

int gnuplot_remove_pictures(const char *folder, const char *name, brunt_error *error) {
    int status = gnuplot_remove_file(folder, name, ".svg", error);
    return status ? status : gnuplot_remove_file(folder, name, ".png", error);
}

// All that gnuplot says, as far as there is room; the rest is read and dropped, so that it is not held up.
static void listen(int descriptor, char *said, size_t size) {
    size_t length = 0;
    char part[512];
    for (;;) {
        ssize_t got = read(descriptor, part, sizeof part);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        for (ssize_t i = 0; i < got && length + 1 < size; i++) said[length++] = part[i] == '\n' ? ' ' : part[i];
    }
    said[length] = 0;
}

// In the folder, so that the script names no place. `*there` is false when there is no gnuplot.
int gnuplot_run(const char *folder, const char *name, bool *there, brunt_error *error) {
    char script[176], said[400] = "";
    snprintf(script, sizeof script, "%s.gp", name);
    char *const arguments[] = {"gnuplot", "-d", script, NULL}; // -d: without settings of the user
    int ends[2], result = 0;
    pid_t child;
    if (pipe2(ends, O_CLOEXEC)) return brunt_fail(error, BRUNT_IO_ERROR, "no pipe for gnuplot: %s", strerror(errno));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
    posix_spawn_file_actions_addchdir_np(&actions, folder);
    int spawned = posix_spawnp(&child, "gnuplot", &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    *there = spawned != ENOENT;
    if (!spawned) {
        listen(ends[0], said, sizeof said);
        while (waitpid(child, &result, 0) < 0 && errno == EINTR) {}
    }
    close(ends[0]);
    if (spawned && *there) return brunt_fail(error, BRUNT_IO_ERROR, "gnuplot cannot be started: %s", strerror(spawned));
    if (!spawned && result)
        return brunt_fail(error, BRUNT_IO_ERROR, "%s/%s: gnuplot refused it: %s", folder, script, said);
    return BRUNT_OK;
}
