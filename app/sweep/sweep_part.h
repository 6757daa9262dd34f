/// Part files: what a shard has run. A header and a line for each item, in `part-0002-of-0008.running` until all of its items are there, and then in
/// `part-0002-of-0008.jsonl`.
#pragma once

#include "machine.h"
#include "suite_measure.h"
#include "wisp/base.h"

// ---- shards: the share of a sweep that a process runs ----

enum
{
    SWEEP_MAX_SHARDS = 9999,
};

typedef struct sweep_shard
{
    int index, count; ///< index from 0; messages and files count from 1
} sweep_shard;

/// Read "2/8": the second of eight.
/// @return WISP_BAD_INPUT it is no such pair, or out of range (the message says what is expected)
wisp_status sweep_shard_parse( const char* text, sweep_shard* out, wisp_error* error );

// ---- records: what a sweep keeps of an item, a line of JSON in a part file ----

enum
{
    SWEEP_MAX_LINE = 1 << 16, ///< bytes
    SWEEP_MAX_TIMES = 2,      ///< with one worker, and with several
};

/// Times of the steps of an item.
typedef struct sweep_time
{
    int workers, steps;
    double median, p10, p90; ///< ms
} sweep_time;

typedef struct sweep_record
{
    int item;     ///< number of the row in the suite
    uint64_t key; ///< hash of its settings: sweep_key()
    uint64_t hash;
    char name[SUITE_MAX_NAME], variant[SUITE_MAX_VARIANT];
    char series[192], along[SUITE_MAX_NAME]; ///< as in a row of a suite
    double along_value, order;
    int steps;
    double values[SUITE_MEASURE_COUNT]; ///< NaN: not measured
    suite_comparison compared;          ///< its distance is the error among the values
    char verdict[32];  ///< of a row with checks: "holds", "refused" or the check that breaks; else empty
    bool is_known;     ///< that verdict is the one that is expected
    char failure[300]; ///< why it could not be run; empty: it was
    sweep_time times[SWEEP_MAX_TIMES];
    int time_count;
    int vertices, substeps; ///< where there are times
} sweep_record;

/// @return the line without its end, for free(); null without memory
char* sweep_record_write( const sweep_record* record );
/// @return false: the line is no record
bool sweep_record_read( const char* line, size_t size, sweep_record* out );

// ---- parts ----

/// What all lines of a part have in common.
typedef struct sweep_header
{
    char suite[SUITE_MAX_NAME], title[160];
    uint64_t key; ///< of the suite
    int items;    ///< of the suite
    int shard, shards;
    bool is_exclusive; ///< nothing else ran on the machine, so it has times
    int workers;       ///< of its times besides one; 0: it has none
    char reference[200];
    double doubt, parts_at; ///< m; s: of the reference. NaN without one; infinity: never
    char version[32], commit[64], compiler[128], flags[300], build_type[32];
    char cpu[128], isa[16], os[192], host[65];
    int cores;
    double memory_bytes;
} sweep_header;

/// Fill in what is true of this program and machine. @param isa as wisp_world_isa() names it
void sweep_describe_machine( const char* isa, sweep_header* out );

/// @return the line without its end, for free(); null without memory
char* sweep_header_write( const sweep_header* header );
/// @return false: the line is no header
bool sweep_header_read( const char* line, size_t size, sweep_header* out );

enum
{
    SWEEP_MAX_PATH = 1024,
};

/// The part of a shard in a folder. @param is_done its name when it is whole
void sweep_part_path( const char* folder, int shard, int shards, bool is_done, char out[SWEEP_MAX_PATH] );
/// Take the numbers from the name of a file. @return false: it is no part
bool sweep_part_of_name( const char* name, int* shard, int* shards, bool* is_done );

/// A part that is read. Zero-initialised is empty.
typedef struct sweep_part
{
    sweep_header header;
    sweep_record* records;
    int count;
    size_t whole; ///< bytes up to the end of the last line, behind which a process was stopped in the middle of one
} sweep_part;

/// Read a part. A last line without an end is left out.
/// @param out to be released, also after a failure
/// @return WISP_BAD_INPUT a line is wrong (the message has its number); WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status sweep_part_read( const char* path, sweep_part* out, wisp_error* error );
/// The same from bytes. @param path for messages
wisp_status sweep_part_parse( const char* bytes, size_t size, const char* path, sweep_part* out, wisp_error* error );
void sweep_part_release( sweep_part* part );

/// @return what differs between two headers so that their parts are not of one sweep, such as "another suite"; null: nothing
const char* sweep_difference( const sweep_header* a, const sweep_header* b );

/// A part that is written.
typedef struct sweep_writer
{
    int file; ///< descriptor, -1: closed
    char running[SWEEP_MAX_PATH], done[SWEEP_MAX_PATH];
    double synced; ///< s, when it was last made sure to be on the disk
    bool is_done;  ///< it was done before: nothing is to be written
} sweep_writer;

/// Begin the part of a shard, or go on with one that was begun.
/// @param resume what is there is kept, and goes to `found`; else it must not be there
/// @param found to be released
/// @return WISP_CONFLICT it is there already, another process writes it, it is of another sweep (the message says which);
///         WISP_IO_ERROR, WISP_BAD_INPUT as sweep_part_read()
wisp_status sweep_writer_open( const char* folder, const sweep_header* header, bool resume, sweep_writer* out,
                               sweep_part* found, wisp_error* error );
/// Add a line. From then on it survives the end of this process.
/// @return WISP_IO_ERROR the disk is full, or such; the line is not in the part
wisp_status sweep_writer_add( sweep_writer* writer, const sweep_record* record, wisp_error* error );
/// Bring everything to the disk, and give the part its name. Closes it in any case.
wisp_status sweep_writer_finish( sweep_writer* writer, wisp_error* error );
/// Close a part that is to be gone on with.
void sweep_writer_close( sweep_writer* writer );
