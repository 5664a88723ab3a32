// The commands of the program. Each takes the arguments after its name and returns the exit code.
#pragma once

#include "brunt.h"
#include "io/scene/scene.h"

int cmd_run(int argc, char **argv);
int cmd_check(int argc, char **argv);
int cmd_keys(int argc, char **argv);
int cmd_info(int argc, char **argv);
int cmd_study(int argc, char **argv);

// What the commands that read a scene have in common.
typedef struct app_arguments {
    const char *operand; // the scene; NULL: none
    const char *folder;  // -o
    const char *trace;   // --trace
    int threads;         // -t, 0: as the scene or all
    const char *sets[256];
    int set_count; // --set
    bool resume, profile, quiet, schema, fresh, quick;
} app_arguments;

typedef enum app_option {
    APP_OUTPUT = 1,
    APP_THREADS = 2,
    APP_SET = 4,
    APP_RESUME = 8,
    APP_PROFILE = 16,
    APP_QUIET = 32,
    APP_SCHEMA = 64,
    APP_TRACE = 128,
    APP_FRESH = 256,
    APP_QUICK = 512
} app_option;

enum { APP_HELPED = -1 };

// Reads options of those `allowed` (app_option, or-ed) and one operand. On a mistake prints one line with a hint and
// returns BRUNT_BAD_USAGE; returns APP_HELPED when help was asked for and printed.
int app_parse(int argc, char **argv, const char *usage, int allowed, bool operand_required, app_arguments *arguments);

// Reads the scene; mistakes go to stderr.
int app_read_scene(const app_arguments *arguments, brunt_scene *scene);
