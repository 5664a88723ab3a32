#include "io/study/report_text.h"

#include <math.h>
#include <string.h>

#include "io/study/study_view.h"

bool report_finished(const brunt_study_case *c) { return c->status == BRUNT_STUDY_DONE; }
bool report_judged(const brunt_study_case *c, int32_t m) {
    return report_finished(c) && isfinite(c->error[m]) && isfinite(c->wall_median);
}

void report_put(FILE *out, const char *text) {
    for (const char *t = text; *t; t++) {
        if (strchr("\\`*_|<>[]", *t)) fputc('\\', out);
        fputc((unsigned char)*t < ' ' ? ' ' : *t, out);
    }
}

void report_put_case(FILE *out, const brunt_study *study, const brunt_study_case *c) {
    char label[320];
    brunt_study_case_label(study, c, label);
    report_put(out, label);
}

void report_put_unit(FILE *out, const brunt_study *study, int32_t m) {
    const char *unit = brunt_study_unit(study, m);
    if (!unit[0]) return;
    fprintf(out, " [");
    report_put(out, unit);
    fprintf(out, "]");
}

words report_percent(double ratio) {
    words w;
    brunt_study_format_percent(ratio, w.text);
    return w;
}

words report_seconds(double value) {
    words w;
    brunt_study_format_seconds(value, w.text);
    return w;
}

words report_factor(double value) {
    words w;
    brunt_study_format_factor(value, w.text);
    return w;
}

const char *report_title(const brunt_study_measure *m) { return m->title[0] ? m->title : m->name; }

int32_t report_count(const brunt_study *study, brunt_study_status status) {
    int32_t count = 0;
    for (int32_t i = 0; i < study->case_count; i++) count += study->cases[i].status == status;
    return count;
}
