// The program: picks a command.
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/app.h"
#include "base/real.h"

static const char help[] =
    "brunt " BRUNT_VERSION ": explicit-dynamics contact engine\n"
    "\n"
    "  brunt run SCENE [-o DIR] [-t THREADS] [--set PATH=VALUE]... [--resume | --fresh] [--profile] [--trace "
    "FILE.json]\n"
    "            [-q]\n"
    "      compute a scene; results go to DIR (out/<scene name>), where only what brunt.files lists is ever replaced. "
    "A run there\n"
    "      that has ended is replaced; one that was stopped or killed is refused: --resume goes on from its "
    "checkpoint, "
    "--fresh\n"
    "      replaces it\n"
    "  brunt check SCENE [-t THREADS] [--quick] [--set PATH=VALUE]...\n"
    "      read and check a scene; print its plan, memory, time step and estimated time\n"
    "  brunt study STUDY [-o DIR] [-t THREADS] [--fresh] [-q]\n"
    "      run a scene over a grid of settings; errors against time, with plots and a report, go to DIR "
    "(out/study/<study\n"
    "      name>); the same command goes on with what is not finished, --fresh begins anew\n"
    "  brunt keys [SECTION | KEY] [--schema]\n"
    "      the reference of scene files (section study: of study files); --schema: as a JSON Schema for editors\n"
    "  brunt info FILE\n"
    "      what a checkpoint, history, picture, collection or mesh file (.msh) holds\n"
    "  brunt --version | --help\n"
    "\n"
    "Exit codes: 0 done, 64 bad command line, 65 bad input, 70 the computation failed, 74 file system, 75 stopped: "
    "--resume goes on.\n"
    "A run asked to stop (SIGTERM, SIGINT, SIGHUP) writes a checkpoint first; SIGUSR1 writes one and goes on.\n";

// Threads that wait at the end of a pass spin for a moment, then sleep. The choice of libgomp is to spin for
// milliseconds, that of libomp for 200, which on a machine with other work keeps the very thread waited for from
// running: two threads were 20 times slower than one there. They read these as they start: libomp with its first
// threads, libgomp after this where it is of the program (CMakeLists.txt), a shared one before.
__attribute__((constructor(101))) static void spin_shortly(void) {
    if (getenv("OMP_WAIT_POLICY")) return;
    setenv("GOMP_SPINCOUNT", "10000", 0);
    setenv("KMP_BLOCKTIME", "1", 0); // [ms]
}

// A stream that the program was started without (>&-) has no descriptor, and the first file that is opened would get
// it: what is printed went into that file. brunt.files was one, whose lines are names that may be removed. What stands
// there instead cannot be read or written, so that it fails as it should.
static bool hold_streams(void) {
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; stream++)
        if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", stream ? O_RDONLY : O_WRONLY) != stream) return false;
    return true;
}

// Whoever closes a pipe wants no more of it: nothing is missed.
static bool reader_gone(void) {
    struct pollfd output = {.fd = STDOUT_FILENO};
    return poll(&output, 1, 0) == 1 && (output.revents & POLLERR);
}

// What was asked for is on the terminal or in its file, or the exit code says that it is not. Runs and studies have
// gone on to their end by then: their results are in files.
static int printed(int status, bool writes_files) {
    if ((!fflush(stdout) && !ferror(stdout)) || (writes_files && reader_gone())) return status;
    fputs("brunt: standard output cannot be written\n", stderr);
    return status ? status : BRUNT_IO_ERROR;
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        int (*run)(int, char **);
        bool writes_files;
    } commands[] = {{"run", cmd_run, true},
                    {"check", cmd_check, false},
                    {"keys", cmd_keys, false},
                    {"info", cmd_info, false},
                    {"study", cmd_study, true}};
    if (!hold_streams()) return BRUNT_IO_ERROR;
    if (argc < 2) {
        fputs("brunt: a command is wanted: run, check, study, keys or info (brunt --help says more)\n", stderr);
        return BRUNT_BAD_USAGE;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
        fputs(help, stdout);
        return printed(BRUNT_OK, false);
    }
    if (!strcmp(argv[1], "--version")) {
        printf("brunt %s (%s precision)\n", BRUNT_VERSION, BRUNT_REAL_NAME);
        return printed(BRUNT_OK, false);
    }
    for (size_t c = 0; c < sizeof commands / sizeof *commands; c++)
        if (!strcmp(argv[1], commands[c].name))
            return printed(commands[c].run(argc - 1, argv + 1), commands[c].writes_files);
    fprintf(stderr,
            "brunt: there is no command '%s'; run, check, study, keys and info are known (brunt --help says more)\n",
            argv[1]);
    return BRUNT_BAD_USAGE;
}
