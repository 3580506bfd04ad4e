/* Counts what runs inside chosen functions: a plugin for QEMU's TCG, API version 1 (QEMU 4.2 on).
 *
 * Arguments: out=FILE, and function=ADDRESS for each function to watch.
 *
 * A call opens a window, which closes when control is back behind the call. Within it, every block
 * of straight code is counted, and every step from one block to the next; that is all that
 * instruction counts and pipeline models need, and it is a few kilobytes where a trace is gigabytes.
 * The output has one line a record:
 *
 *   call FUNCTION TIMES
 *   block ID ADDRESS SIZE,SIZE,...       one size in bytes for each instruction
 *   count FUNCTION BLOCK TIMES
 *   step FUNCTION BLOCK BLOCK TIMES      the last step of a window leads out of it
 *
 * Debian has no package with qemu-plugin.h, so the few functions used are declared here.
 */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t plugin_id;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id, void (*)(plugin_id, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *, void (*)(unsigned, void *), int,
                                          void *);
void qemu_plugin_register_atexit_cb(plugin_id, void (*)(plugin_id, void *), void *);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
size_t qemu_plugin_insn_size(const struct qemu_plugin_insn *);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);

#define EXPORT __attribute__((visibility("default")))
EXPORT int qemu_plugin_version = 1;

enum { MAX_FUNCTIONS = 256, TABLE_SIZE = 1 << 16 };

struct block;

struct step {
    struct block *to;
    int function;
    uint64_t times;
    struct step *next;
};

/* Straight code, as QEMU translates it: from `start` up to `end`. */
struct block {
    uint64_t start, end;
    int id, instructions;
    unsigned char *sizes;
    int opens; /* the function that starts here, or -1 */
    uint64_t *times; /* by function */
    struct step *steps;
    struct block *next;
};

static struct block *blocks[TABLE_SIZE];
static int block_count;
static uint64_t functions[MAX_FUNCTIONS], calls[MAX_FUNCTIONS];
static int function_count;
static const char *out_file;

static int window = -1;      /* the open function */
static uint64_t return_address;
static struct block *previous; /* the block that ran last */

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (!memory) {
        fputs("icount: out of memory\n", stderr);
        exit(2);
    }
    return memory;
}

static void count_step(struct block *from, struct block *to)
{
    struct step **link = &from->steps;
    while (*link && ((*link)->to != to || (*link)->function != window))
        link = &(*link)->next;
    struct step *step = *link;
    if (step) {
        /* To the front: the next search is likely for the same. */
        *link = step->next;
    } else {
        step = allocate(1, sizeof *step);
        step->to = to;
        step->function = window;
    }
    step->times++;
    step->next = from->steps;
    from->steps = step;
}

static void on_block(unsigned cpu, void *data)
{
    (void)cpu;
    struct block *block = data;
    if (window >= 0) {
        count_step(previous, block);
        if (block->start == return_address)
            window = -1;
        else
            block->times[window]++;
    } else if (block->opens >= 0 && previous) {
        window = block->opens;
        return_address = previous->end;
        calls[window]++;
        block->times[window]++;
    }
    previous = block;
}

static struct block *find_block(const struct qemu_plugin_tb *tb)
{
    int instructions = (int)qemu_plugin_tb_n_insns(tb);
    uint64_t start = qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(tb, 0));
    struct block **link = &blocks[(start >> 1) % TABLE_SIZE];
    while (*link && ((*link)->start != start || (*link)->instructions != instructions))
        link = &(*link)->next;
    if (*link)
        return *link;

    struct block *block = allocate(1, sizeof *block);
    *link = block;
    block->start = block->end = start;
    block->id = block_count++;
    block->instructions = instructions;
    block->sizes = allocate(instructions, 1);
    block->times = allocate(function_count, sizeof *block->times);
    for (int i = 0; i < instructions; i++) {
        /* By the next one's address: near the end of a page QEMU peeks at the next instruction, and
           counts what it has read as part of this one. */
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, i);
        block->sizes[i] = (unsigned char)(
            i + 1 < instructions ? qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(tb, i + 1)) -
                                       qemu_plugin_insn_vaddr(insn)
                                 : qemu_plugin_insn_size(insn));
        block->end += block->sizes[i];
    }
    block->opens = -1;
    for (int i = 0; i < function_count; i++)
        if (functions[i] == start)
            block->opens = i;
    return block;
}

static void on_translation(plugin_id id, struct qemu_plugin_tb *tb)
{
    (void)id;
    qemu_plugin_register_vcpu_tb_exec_cb(tb, on_block, 0, find_block(tb));
}

static void print_block(FILE *out, const struct block *block)
{
    fprintf(out, "block %d %" PRIx64 " ", block->id, block->start);
    for (int i = 0; i < block->instructions; i++)
        fprintf(out, "%s%d", i ? "," : "", block->sizes[i]);
    fputc('\n', out);
    for (int i = 0; i < function_count; i++)
        if (block->times[i])
            fprintf(out, "count %d %d %" PRIu64 "\n", i, block->id, block->times[i]);
    for (const struct step *step = block->steps; step; step = step->next)
        fprintf(out, "step %d %d %d %" PRIu64 "\n", step->function, block->id, step->to->id,
                step->times);
}

static void on_exit_write(plugin_id id, void *data)
{
    (void)id;
    (void)data;
    FILE *out = fopen(out_file, "w");
    if (!out) {
        perror(out_file);
        return;
    }
    for (int i = 0; i < function_count; i++)
        fprintf(out, "call %d %" PRIu64 "\n", i, calls[i]);
    for (int slot = 0; slot < TABLE_SIZE; slot++)
        for (const struct block *block = blocks[slot]; block; block = block->next)
            print_block(out, block);
    if (fclose(out))
        perror(out_file);
}

EXPORT int qemu_plugin_install(plugin_id id, const void *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        if (!strncmp(argv[i], "out=", 4)) {
            out_file = strdup(argv[i] + 4);
        } else if (!strncmp(argv[i], "function=", 9) && function_count < MAX_FUNCTIONS) {
            /* Thumb's symbols have the lowest bit set. */
            functions[function_count++] = strtoull(argv[i] + 9, NULL, 0) & ~1ULL;
        } else {
            fprintf(stderr, "icount: cannot use argument %s\n", argv[i]);
            return 1;
        }
    }
    if (!out_file || !function_count) {
        fputs("icount: needs out=FILE and function=ADDRESS\n", stderr);
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
    qemu_plugin_register_atexit_cb(id, on_exit_write, NULL);
    return 0;
}
