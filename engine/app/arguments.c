#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"

static const struct {
    app_option option;
    struct option form;
} options[] = {
    {APP_OUTPUT, {"output", required_argument, NULL, 'o'}}, {APP_THREADS, {"threads", required_argument, NULL, 't'}},
    {APP_SET, {"set", required_argument, NULL, 's'}},       {APP_RESUME, {"resume", no_argument, NULL, 'r'}},
    {APP_PROFILE, {"profile", no_argument, NULL, 'p'}},     {APP_QUIET, {"quiet", no_argument, NULL, 'q'}},
    {APP_SCHEMA, {"schema", no_argument, NULL, 'S'}},       {APP_TRACE, {"trace", required_argument, NULL, 'T'}},
    {APP_FRESH, {"fresh", no_argument, NULL, 'F'}},         {APP_QUICK, {"quick", no_argument, NULL, 'Q'}},
};
enum { OPTION_COUNT = sizeof options / sizeof *options };

__attribute__((format(printf, 2, 3))) static int bad_usage(const char *usage, const char *format, ...) {
    va_list arguments;
    fputs("brunt: ", stderr);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, " (usage: %s)\n", usage);
    return BRUNT_BAD_USAGE;
}

static bool parse_threads(const char *text, int *threads) {
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (errno || end == text || *end || value < 1 || value > BRUNT_THREAD_LIMIT) return false;
    *threads = (int)value;
    return true;
}

int app_parse(int argc, char **argv, const char *usage, int allowed, bool operand_required, app_arguments *arguments) {
    struct option forms[OPTION_COUNT + 2];
    char letters[32] = "+:h";
    int count = 0;
    for (int o = 0; o < OPTION_COUNT; o++) {
        if (!(allowed & (int)options[o].option)) continue;
        forms[count++] = options[o].form;
        // Only these three have a short form that is documented; -s, -r, -p, -S, -T, -F, -Q are private to this table.
        if (strchr("otq", options[o].form.val)) {
            size_t length = strlen(letters);
            letters[length] = (char)options[o].form.val;
            strcpy(letters + length + 1, options[o].form.has_arg ? ":" : "");
        }
    }
    forms[count++] = (struct option){"help", no_argument, NULL, 'h'};
    forms[count] = (struct option){0};
    memset(arguments, 0, sizeof *arguments);
    opterr = 0;
    optind = 1;
    // Operands may stand before, between and after options.
    while (optind < argc) {
        int option = getopt_long(argc, argv, letters, forms, NULL);
        switch (option) {
        case -1:
            // getopt stops at an operand, or has just swallowed "--".
            if (optind >= argc) break;
            if (arguments->operand) return bad_usage(usage, "one file is wanted, '%s' is one too many", argv[optind]);
            arguments->operand = argv[optind++];
            break;
        case 'o': arguments->folder = optarg; break;
        case 't':
            if (!parse_threads(optarg, &arguments->threads))
                return bad_usage(usage, "'%s' is no number of threads; 1 to %d are wanted", optarg, BRUNT_THREAD_LIMIT);
            break;
        case 's':
            if (!strchr(optarg, '=')) return bad_usage(usage, "--set %s: PATH=VALUE is wanted", optarg);
            if (arguments->set_count == (int)(sizeof arguments->sets / sizeof *arguments->sets))
                return bad_usage(usage, "more than %d times --set", arguments->set_count);
            arguments->sets[arguments->set_count++] = optarg;
            break;
        case 'r': arguments->resume = true; break;
        case 'p': arguments->profile = true; break;
        case 'q': arguments->quiet = true; break;
        case 'S': arguments->schema = true; break;
        case 'F': arguments->fresh = true; break;
        case 'T': arguments->trace = optarg; break;
        case 'Q': arguments->quick = true; break;
        case 'h': printf("usage: %s\n", usage); return APP_HELPED;
        case ':': return bad_usage(usage, "%s wants a value", argv[optind - 1]);
        default: return bad_usage(usage, "there is no option %s here", argv[optind - 1]);
        }
    }
    if (operand_required && !arguments->operand) return bad_usage(usage, "a file is wanted");
    if (arguments->resume && arguments->fresh)
        return bad_usage(usage, "--resume goes on, --fresh begins anew: one of them");
    if (arguments->folder && !*arguments->folder) return bad_usage(usage, "-o wants the name of a folder");
    if (arguments->trace && !*arguments->trace) return bad_usage(usage, "--trace wants the name of a file");
    return BRUNT_OK;
}

int app_read_scene(const app_arguments *arguments, brunt_scene *scene) {
    int status = brunt_scene_read(arguments->operand, arguments->sets, arguments->set_count, scene, stderr);
    if (!status && arguments->threads) scene->world.threads = arguments->threads;
    return status;
}
