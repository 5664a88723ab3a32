#include <stdio.h>

#include "app.h"

int cmd_keys(int argc, char **argv) {
    app_arguments arguments;
    int status = app_parse(argc, argv, "brunt keys [SECTION] [--schema]", APP_SCHEMA, false, &arguments);
    if (status) return status < 0 ? BRUNT_OK : status;
    if (arguments.schema) {
        brunt_scene_schema(stdout);
    } else if (!brunt_scene_keys(arguments.operand, stdout)) {
        fprintf(stderr, "brunt: there is no section '%s'; brunt keys lists all\n", arguments.operand);
        return BRUNT_BAD_USAGE;
    }
    return fflush(stdout) ? BRUNT_IO_ERROR : BRUNT_OK;
}
