/* A motion from event to event, under an input of pieces: what it is at given times, and its impacts.
 *
 * Each piece is set where it begins and runs on, so the motion does not depend on where it is read. Where a buffer is full the loop pauses.
 * fmu/events.py has the same structures.
 */
#include "fmi.h"

typedef struct {
    Fmi fmi;
    const unsigned *inputs, *outputs, *impact_outputs, *contact;
    size_t input_count, output_count, impact_output_count;
} Player;

typedef struct {  /* what there is to do; arrays by rows */
    const double *nodes, *derivatives, *samples;
    size_t piece_count, sample_count;
    double *rows;
    bool *contacts;
    double *impacts;  /* of each its time, the outputs after it, and whether contact begins */
    size_t impact_capacity, max_steps;
} Task;

typedef struct {  /* what is done, over all calls; of the impacts, in this one */
    double time;
    size_t piece, sample, impact;
    bool piece_is_set;
} Progress;

EXPORT const unsigned sizes_of_play[] = {sizeof(Player), sizeof(Task), sizeof(Progress)};  /* Python has to have the same */

static bool keep_impact(Player *player, const Task *task, Progress *progress) {
    size_t count = player->impact_output_count;
    double *row = task->impacts + progress->impact * (count + 2);
    bool contact;
    row[0] = progress->time;
    if (!get_reals(&player->fmi, player->impact_outputs, count, row + 1, count) || !get_boolean(&player->fmi, *player->contact, &contact)) return false;
    row[count + 1] = contact;
    progress->impact++;
    return handle_event(&player->fmi);
}

static bool read_sample(Player *player, const Task *task, Progress *progress) {
    size_t i = progress->sample++, count = player->output_count;
    return get_reals(&player->fmi, player->outputs, count, task->rows + i * count, count) && get_boolean(&player->fmi, *player->contact, task->contacts + i);
}

/* Play from where the progress stands: DONE, PAUSED for the caller to take the impacts away, or BROKEN. */
EXPORT int play(Player *player, const Task *task, Progress *progress) {
    size_t steps = 0;
    progress->impact = 0;
    for (; progress->piece < task->piece_count; progress->piece++, progress->piece_is_set = false) {
        double end = task->nodes[progress->piece + 1];
        const double *values = task->derivatives + progress->piece * player->input_count;
        if (!progress->piece_is_set && !set_reals(&player->fmi, player->inputs, player->input_count, values)) return BROKEN;
        progress->piece_is_set = true;
        for (bool reads = true; reads;) {
            reads = progress->sample < task->sample_count && task->samples[progress->sample] < end;
            double target = reads ? task->samples[progress->sample] : end;
            while (progress->time < target) {
                bool event;
                if (steps++ == task->max_steps || progress->impact == task->impact_capacity) return PAUSED;
                if (!do_step(&player->fmi, progress->time, target, &event, &progress->time)) return BROKEN;
                if (event && !keep_impact(player, task, progress)) return BROKEN;
            }
            if (reads && !read_sample(player, task, progress)) return BROKEN;
        }
    }
    while (progress->sample < task->sample_count) if (!read_sample(player, task, progress)) return BROKEN;  /* at the last node */
    return DONE;
}
