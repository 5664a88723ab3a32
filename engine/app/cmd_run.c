#include <signal.h>
#include <stdio.h>

#include "app/app.h"
#include "base/parallel.h"
#include "io/run/run.h"

// A signal handler can reach nothing but what is static; it sets a flag, the run loop does the rest.
static volatile sig_atomic_t stop_asked, save_asked;

static void on_stop(int number) {
    (void)number;
    stop_asked = 1;
}

static void on_save(int number) {
    (void)number;
    save_asked = 1;
}

static void handle(int number, void (*handler)(int)) {
    struct sigaction old, action = {.sa_handler = handler, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    // A program started with a signal ignored (nohup) goes on ignoring it.
    if (sigaction(number, NULL, &old) == 0 && old.sa_handler == SIG_IGN) return;
    sigaction(number, &action, NULL);
}

int cmd_run(int argc, char **argv) {
    app_arguments arguments;
    int status =
        app_parse(argc, argv,
                  "brunt run SCENE [-o DIR] [-t THREADS] [--set PATH=VALUE]... [--resume | --fresh] [--profile] "
                  "[--trace FILE.json] [-q]",
                  APP_OUTPUT | APP_THREADS | APP_SET | APP_RESUME | APP_FRESH | APP_PROFILE | APP_TRACE | APP_QUIET,
                  true, &arguments);
    if (status) return status < 0 ? BRUNT_OK : status;
    brunt_parallel_adapt(true);
    // A run of hours must not end because the reader of its output has gone, nor without a word because a file may not
    // grow.
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    handle(SIGTERM, on_stop);
    handle(SIGINT, on_stop);
    handle(SIGHUP, on_stop);
    handle(SIGUSR1, on_save);

    brunt_scene scene;
    status = app_read_scene(&arguments, &scene);
    if (status) return status;
    const brunt_run_options options = {.folder = arguments.folder,
                                       .resume = arguments.resume,
                                       .fresh = arguments.fresh,
                                       .profile = arguments.profile,
                                       .trace = arguments.trace,
                                       .console = arguments.quiet ? NULL : stdout,
                                       .messages = stderr,
                                       .stop = &stop_asked,
                                       .save = &save_asked};
    brunt_error error;
    status = brunt_run(&scene, &options, &error);
    if (status && status != BRUNT_BAD_INPUT) fprintf(stderr, "brunt: %s\n", error.message);
    brunt_scene_free(&scene);
    return status;
}
