// The program as a user meets it: started with words, its exit code and what it says.
#pragma once

#include "tests/support/small_scene.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static inline const char *small_program(void) {
    const char *path = getenv("BRUNT");
    ck_assert_msg(path != NULL, "BRUNT must name the program");
    return path;
}

// Of a command of the shell in the test's folder; "$B" there is the program.
__attribute__((format(printf, 1, 2))) static inline int small_shell(const char *format, ...) {
    char command[2048];
    int used = snprintf(command, sizeof command, "cd '%s' && B='%s'; ", small_folder, small_program());
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command + used, sizeof command - (size_t)used, format, arguments);
    va_end(arguments);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

// Runs "$B ARGUMENTS" in the test's folder: `code` is wanted, and `text` in what it prints.
static inline void small_expect(const char *arguments, int code, const char *text) {
    long size;
    int found = small_shell("$B %s > output 2>&1 < /dev/null", arguments);
    char *output = small_read(small_path("output"), &size);
    ck_assert_msg(found == code, "%s: %d instead of %d\n%s", arguments, found, code, output);
    ck_assert_msg(!text || strstr(output, text), "%s: '%s' is not in\n%s", arguments, text, output);
    free(output);
}

static inline bool small_exists(const char *name) { return access(small_path(name), F_OK) == 0; }
static inline void small_put(const char *name, const char *text) {
    small_write(small_path(name), text, (long)strlen(text));
}

static inline void small_wait(double seconds) {
    struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&time, NULL);
}

// Starts "run small.yaml -t 1 -q -o FOLDER ..." and waits until the file `sign` is there. To be ended with small_end.
static inline pid_t small_begin(const char *folder, const char *sign, const char *const *more, int count) {
    const char *words[32] = {small_program(), "run", "small.yaml", "-t", "1", "-q", "-o", folder};
    for (int w = 0; w < count; w++) words[8 + w] = more[w];
    pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        int out = open("/dev/null", O_RDWR);
        dup2(out, 1), dup2(out, 2);
        if (chdir(small_folder) == 0) execv(words[0], (char *const *)words);
        _exit(127);
    }
    while (!small_exists(sign)) {
        ck_assert_int_eq(waitpid(child, NULL, WNOHANG), 0);
        small_wait(0.002);
    }
    return child;
}

static inline int small_end(pid_t child, int signal) {
    int status;
    kill(child, signal);
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}
