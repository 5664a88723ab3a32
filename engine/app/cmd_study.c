// A scene over a grid of settings: what accuracy costs in time.
#include <signal.h>
#include <stdio.h>
#include <unistd.h>

#include "app/app.h"
#include "io/study/study.h"

static volatile sig_atomic_t stop_asked;

static void on_stop(int number) {
    (void)number;
    stop_asked = 1;
}

static void handle(int number) {
    struct sigaction old, action = {.sa_handler = on_stop, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    // A program started with a signal ignored (nohup) goes on ignoring it.
    if (sigaction(number, NULL, &old) == 0 && old.sa_handler == SIG_IGN) return;
    sigaction(number, &action, NULL);
}

// The file of this very program, also when it was found through PATH.
static bool own_program(char out[4096]) {
    ssize_t length = readlink("/proc/self/exe", out, 4095);
    if (length <= 0) return false;
    out[length] = 0;
    return true;
}

int cmd_study(int argc, char **argv) {
    app_arguments arguments;
    int status = app_parse(argc, argv, "brunt study STUDY [-o DIR] [-t THREADS] [--fresh] [-q]",
                           APP_OUTPUT | APP_THREADS | APP_FRESH | APP_QUIET, true, &arguments);
    if (status) return status < 0 ? BRUNT_OK : status;
    signal(SIGPIPE, SIG_IGN);
    signal(SIGCHLD, SIG_DFL); // ignored, there are no exit codes
    handle(SIGTERM);
    handle(SIGINT);
    handle(SIGHUP);

    brunt_study study;
    char program[4096];
    status = brunt_study_read(arguments.operand, &study, stderr);
    if (status) return status;
    if (arguments.threads) study.threads = arguments.threads;
    brunt_error error = {0};
    if (own_program(program)) {
        const brunt_study_options options = {.folder = arguments.folder,
                                             .program = program,
                                             .fresh = arguments.fresh,
                                             .console = arguments.quiet ? NULL : stdout,
                                             .stop = &stop_asked};
        status = brunt_study_run(&study, &options, &error);
        if (status) fprintf(stderr, "brunt: %s\n", error.message);
    } else {
        fputs("brunt: /proc/self/exe cannot be read: which program is to run the scenes?\n", stderr);
        status = BRUNT_IO_ERROR;
    }
    brunt_study_free(&study);
    return status;
}
