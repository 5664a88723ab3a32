// Version, limits, and how the library reports: codes and messages.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BRUNT_VERSION "0.1.0"

// Numbers of a definition are at most so large [SI], so that their products are numbers as well; what must be above 0
// is at least so large, and nothing else but 0 is smaller than normal numbers are. INFINITY and NAN stand where it is
// said that they do.
#ifdef BRUNT_FLOAT
#define BRUNT_GREATEST_NUMBER 1e18
#define BRUNT_LEAST_NUMBER 1e-18
#define BRUNT_LEAST_NORMAL 1.2e-38
#else
#define BRUNT_GREATEST_NUMBER 1e30
#define BRUNT_LEAST_NUMBER 1e-30
#define BRUNT_LEAST_NORMAL 2.3e-308
#endif

// The one limit on threads (worlds, runs, studies), and what names and materials' parameters have room for.
enum {
    BRUNT_THREAD_LIMIT = 256,
    BRUNT_NAME_LENGTH = 48, // [bytes] with the 0 at the end
    BRUNT_PARAMETER_LIMIT = 24
};

enum {                    // also the exit codes of the program
    BRUNT_OK = 0,         // done
    BRUNT_BAD_USAGE = 64, // command line
    BRUNT_BAD_INPUT = 65, // scene, mesh or checkpoint that is not acceptable
    BRUNT_FAILED = 70,    // the computation failed: body, id, place, time and reason say where and why
    BRUNT_IO_ERROR = 74,  // file system
    BRUNT_STOPPED = 75    // stopped by a signal; resume from the checkpoint
};

// What went wrong. Every function that takes one fills it when it returns anything but BRUNT_OK; NULL where
// the message is not wanted.
typedef struct brunt_error {
    int code;           // the one that is returned
    char message[1024]; // complete sentence, with the values that matter
    char body[64];      // for BRUNT_FAILED: body ...
    int64_t id;         // ... particle id (-1: none) ...
    double position[3]; // [m] where
    double time;        // [s] of the step that failed
} brunt_error;

#ifdef __cplusplus
}
#endif
