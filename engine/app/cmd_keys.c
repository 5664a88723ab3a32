#include <stdio.h>

#include "app/app.h"
#include "io/scene/scene_keys.h"

int cmd_keys(int argc, char **argv) {
    app_arguments arguments;
    int status = app_parse(argc, argv, "brunt keys [SECTION | KEY] [--schema]", APP_SCHEMA, false, &arguments);
    if (status) return status < 0 ? BRUNT_OK : status;
    if (arguments.schema) {
        brunt_scene_schema(stdout);
    } else if (!brunt_scene_keys(arguments.operand, stdout)) {
        fprintf(stderr, "brunt: there is no section or key '%s'; sections are:", arguments.operand);
        for (int s = 0; s < brunt_scene_section_count; s++) fprintf(stderr, " %s", brunt_scene_sections[s].name);
        fputs(" history presets study, and the names of models", stderr);
        fputc('\n', stderr);
        return BRUNT_BAD_USAGE;
    }
    return BRUNT_OK;
}
