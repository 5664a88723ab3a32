#include "io/study/child.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/error.h"
#include "base/parallel.h"

enum { GRACE = 10 }; // [s] a child has to write its checkpoint

// In the child: nothing but calls that are safe after fork. Errors go through the pipe, which a good exec closes.
static void become(char *const *arguments, int messages, int pipe_end, pid_t parent) {
    int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    bool orphan = getppid() != parent; // it ended before the line above
    if (!orphan && nothing >= 0 && dup2(nothing, 0) >= 0 && dup2(nothing, 1) >= 0 && dup2(messages, 2) >= 0)
        execv(arguments[0], arguments);
    int reason = errno;
    if (write(pipe_end, &reason, sizeof reason) < 0) _exit(126);
    _exit(127);
}

// 0, or why the exec failed.
static int exec_result(int pipe_end) {
    int reason = 0;
    ssize_t got;
    do { got = read(pipe_end, &reason, sizeof reason); } while (got < 0 && errno == EINTR);
    close(pipe_end);
    return got == (ssize_t)sizeof reason ? reason : 0;
}

static int start(char *const *arguments, const char *messages, pid_t *child, brunt_error *error) {
    int ends[2];
    int file = open(messages, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot be written: %s", messages, strerror(errno));
    if (pipe2(ends, O_CLOEXEC) != 0) {
        close(file);
        return brunt_fail(error, BRUNT_IO_ERROR, "no pipe: %s", strerror(errno));
    }
    pid_t parent = getpid();
    *child = fork();
    if (*child == 0) become(arguments, file, ends[1], parent);
    int reason = *child < 0 ? errno : 0;
    close(file);
    close(ends[1]);
    if (*child < 0)
        close(ends[0]);
    else if ((reason = exec_result(ends[0])))
        waitpid(*child, NULL, 0);
    return reason ? brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot be run: %s", arguments[0], strerror(reason))
                  : BRUNT_OK;
}

// Looks rarely at what takes long: its time is taken by itself, not here.
static void pause_for(double seconds) {
    struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&time, NULL); // a signal ends it early, which is welcome
}

int brunt_child_run(char *const *arguments, const char *messages, double limit, const volatile sig_atomic_t *stop,
                    brunt_child_end *end, brunt_error *error) {
    double begin = brunt_clock(), told = INFINITY, nap = 0.5e-3;
    pid_t child = -1;
    *end = (brunt_child_end){.fate = BRUNT_CHILD_ENDED};
    int status = start(arguments, messages, &child, error), state = 0;
    if (status) return status;
    while (waitpid(child, &state, WNOHANG) == 0) {
        double now = brunt_clock();
        if (stop && *stop && isinf(told)) {
            kill(child, SIGTERM);
            told = now;
        }
        if (now - begin > limit || now - told > GRACE) {
            kill(child, SIGKILL);
            if (isinf(told)) end->fate = BRUNT_CHILD_TIMEOUT;
            limit = INFINITY;
        }
        pause_for(nap);
        nap = fmin(1.5 * nap, 20e-3);
    }
    end->seconds = brunt_clock() - begin;
    end->code = WIFEXITED(state) ? WEXITSTATUS(state) : WTERMSIG(state);
    if (isfinite(told) || (WIFEXITED(state) && end->code == BRUNT_STOPPED))
        end->fate = BRUNT_CHILD_STOPPED;
    else if (end->fate != BRUNT_CHILD_TIMEOUT && !WIFEXITED(state))
        end->fate = BRUNT_CHILD_KILLED;
    return BRUNT_OK;
}
