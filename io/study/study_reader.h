// What reading and running a study share: what a case comes to when its values are put in. Private to study_*.c.
#pragma once

#include "io/study/study.h"

// Which entry of the file brought a set: number `set` of a value of an axis; axis -1: of the study's own `set`.
typedef struct study_origin {
    int32_t axis, value, set;
} study_origin;

// What is handed to the program for one case. Sets of values may be "path*=factor": what the scene has there (with all
// other sets) times the factor. Here such a set has become "path=value".
typedef struct study_job {
    char scene[1024], program[1024]; // program "": this one
    int32_t threads;
    char **sets; // owned
    study_origin *origins;
    int32_t set_count;
} study_job;

// On BRUNT_BAD_INPUT a scaled path is not there or no number, and `culprit` is what asked for it. The job is to be
// freed in any case.
int brunt_study_job(const brunt_study *study, const brunt_study_case *c, study_job *job, study_origin *culprit,
                    brunt_error *error);
void brunt_study_job_free(study_job *job);

// The axis of a placeholder {NAME}, {NAME*2}, {NAME/2} that begins at `text`, its factor and what is behind it; -1: it
// is none. *unknown: it is written like one, of an axis there is not.
int32_t brunt_study_placeholder(const brunt_study *study, const char *text, double *factor, const char **rest,
                                bool *unknown);

// A copy in the library's memory; NULL for NULL or none left.
char *brunt_study_copy(const char *text);
