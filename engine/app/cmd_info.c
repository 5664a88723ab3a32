#include <stdio.h>

#include "app/app.h"
#include "io/output/describe.h"

int cmd_info(int argc, char **argv) {
    app_arguments arguments;
    int status = app_parse(argc, argv, "brunt info FILE", 0, true, &arguments);
    if (status) return status < 0 ? BRUNT_OK : status;
    brunt_error error = {0};
    status = brunt_describe_file(arguments.operand, stdout, &error);
    if (status) fprintf(stderr, "brunt: %s\n", error.message);
    return status;
}
