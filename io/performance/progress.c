#include "io/performance/progress.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

#include "base/parallel.h"

void brunt_duration(double seconds, char out[32]) {
    if (!(seconds >= 0 && seconds < 1e9)) {
        strcpy(out, "?");
        return;
    }
    long s = lround(seconds);
    if (s >= 3600)
        snprintf(out, 32, "%ld h %02ld min", s / 3600, s / 60 % 60);
    else if (s >= 60)
        snprintf(out, 32, "%ld min %02ld s", s / 60, s % 60);
    else
        snprintf(out, 32, "%.*f s", s < 10, seconds);
}

void brunt_counts(const brunt_world *world, char out[64]) {
    long long particles = brunt_world_particles(world), elements = brunt_world_elements(world);
    int used = 0;
    if (particles || !elements) used = snprintf(out, 64, "%lld particles", particles);
    if (elements) snprintf(out + used, 64 - (size_t)used, "%s%lld elements", used ? ", " : "", elements);
}

brunt_console brunt_console_open(FILE *out) {
    return (brunt_console){.out = out, .terminal = out && isatty(fileno(out))};
}

static void close_line(brunt_console *console) {
    if (console->line_open) fputc('\n', console->out);
    console->line_open = false;
}

static void log_flush(brunt_console *console) {
    if (console->log && (fflush(console->log) || ferror(console->log))) console->log_failed = true;
}

void brunt_console_print(brunt_console *console, const char *format, ...) {
    va_list arguments;
    if (console->out) {
        close_line(console);
        va_start(arguments, format);
        vfprintf(console->out, format, arguments);
        va_end(arguments);
        fflush(console->out);
    }
    if (console->log) {
        va_start(arguments, format);
        vfprintf(console->log, format, arguments);
        va_end(arguments);
        log_flush(console);
    }
}

brunt_progress brunt_progress_start(brunt_console *console, const brunt_world *world) {
    double now = brunt_clock(), time = brunt_world_time(world);
    // Ten seconds between lines of a log, the first after one.
    return (brunt_progress){.console = console,
                            .start_time = time,
                            .start_wall = now,
                            .shown_wall = now,
                            .logged_wall = now - 9,
                            .rate_wall = now,
                            .rate_time = time,
                            .rate_steps = brunt_world_steps(world)};
}

// Newton's method in the last step of implicit schemes.
static void format_newton(const brunt_world *world, char *text, size_t room) {
    brunt_newton_counts last;
    text[0] = 0;
    if (!brunt_world_newton(world, NULL, &last)) return;
    const int used = snprintf(text, room, "  newton %.0f to %.2g%s", last.iterations, last.residual,
                              brunt_world_static(world) ? " of forces" : " m/s");
    if (isfinite(last.least_part)) snprintf(text + used, room - (size_t)used, "  gap %.2g", last.least_part);
}

static void format_line(const brunt_progress *p, brunt_world *world, char *line, size_t room) {
    brunt_energy energy;
    brunt_world_energy(world, &energy);
    double time = brunt_world_time(world), end = brunt_world_end(world);
    double particles = (double)brunt_world_particles(world), elements = (double)brunt_world_elements(world);
    char left[32], rates[96] = "", newton[64];
    int used = 0;
    if (particles > 0)
        used = snprintf(rates, sizeof rates, "  %.3g M particle-steps/s", 1e-6 * p->steps_per_second * particles);
    if (elements > 0)
        snprintf(rates + used, sizeof rates - (size_t)used, "  %.3g M element-steps/s",
                 1e-6 * p->steps_per_second * elements);
    brunt_duration((end - time) / p->time_per_second, left);
    format_newton(world, newton, sizeof newton);
    snprintf(line, room, "step %lld  t %.4g s  dt %.3g s%s  energy error %.3g %%%s  %.1f %%  %s left",
             (long long)brunt_world_steps(world), time, brunt_world_dt(world), newton, 100 * energy.error_relative,
             rates, 100 * time / end, left);
}

static void show(brunt_console *console, const char *line, double share) {
    enum { WIDTH = 20 };
    if (!console->terminal) {
        fprintf(console->out, "%s\n", line);
    } else {
        char bar[WIDTH + 1];
        int full = share < 0 ? 0 : share > 1 ? WIDTH : (int)(share * WIDTH);
        for (int i = 0; i < WIDTH; i++) bar[i] = i < full ? '#' : '.';
        bar[WIDTH] = 0;
        fprintf(console->out, "\r[%s] %s\033[K", bar, line);
        console->line_open = true;
    }
    fflush(console->out);
}

void brunt_progress_update(brunt_progress *p, brunt_world *world) {
    double now = brunt_clock();
    bool log_due = now - p->logged_wall >= 10, show_due = p->console->terminal ? now - p->shown_wall >= 0.5 : log_due;
    if (!log_due && !show_due) return;
    // Rates are of the last two seconds or more, so that the time left follows a changing step without jumping about.
    double window = now - p->rate_wall;
    if (window >= 2 || p->steps_per_second == 0) {
        p->steps_per_second = (double)(brunt_world_steps(world) - p->rate_steps) / window;
        p->time_per_second = (brunt_world_time(world) - p->rate_time) / window;
        p->rate_wall = now;
        p->rate_time = brunt_world_time(world);
        p->rate_steps = brunt_world_steps(world);
    }
    char line[256];
    format_line(p, world, line, sizeof line);
    if (show_due && p->console->out) {
        show(p->console, line, brunt_world_time(world) / brunt_world_end(world));
        p->shown_wall = now;
    }
    if (log_due) {
        if (p->console->log) fprintf(p->console->log, "%s\n", line);
        log_flush(p->console);
        p->logged_wall = now;
    }
}

void brunt_progress_end(brunt_progress *progress) { close_line(progress->console); }
