#include "contact/methods/augury_work.h"

#include "base/array.h"
#include "base/memory.h"

brunt_augury_workspace *brunt_augury_work(brunt_augury_workspace **work, brunt_error *error) {
    return *work || !BRUNT_NEW(*work, 1, "room for augury", error) ? *work : NULL;
}

void brunt_augury_workspace_free(brunt_augury_workspace *work) {
    if (!work) return;
    brunt_augury_near_free(&work->near);
    brunt_augury_grid_free(&work->grid);
    for (int c = 0; c < 4; c++) brunt_augury_cloud_free(&work->cloud[c]);
    brunt_averaged_work_free(work->averaged);
    brunt_published_work_free(work->published);
    brunt_free(work);
}
