// The folder of a run: what it will write there, and whether it may.
#pragma once

#include "io/file/output_folder.h"
#include "io/output/pvd.h"
#include "io/run/run.h"

// Opens and locks the folder and looks at all that the run is going to write. BRUNT_BAD_INPUT, with nothing touched:
// another run is at work there, something that is not brunt's or the scene itself is in the way, or a new run would
// take the place of an unfinished one.
int brunt_run_folder_open(brunt_output_folder *folder, const brunt_scene *scene, const brunt_run_options *options,
                          const char *path, brunt_error *error);
// Makes the folder ready: the resolved scene is written; of an earlier run all else goes, unless this one goes on with
// it.
int brunt_run_folder_prepare(brunt_output_folder *folder, const brunt_run_options *options, const char *scene_text,
                             brunt_error *error);
// Lists the picture of this number in all its parts, before they are written.
int brunt_run_folder_list_picture(brunt_output_folder *folder, const brunt_picture_parts *parts, int64_t number,
                                  brunt_error *error);
