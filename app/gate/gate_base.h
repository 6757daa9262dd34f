/// A base file: what the rows of a suite measured when they were good, as JSON.
#pragma once

#include "suite_measure.h"

enum
{
    GATE_VERSION = 4, ///< 2: instructions by pass; 3: errors; 4: cycles, iterations of solvers
    GATE_MAX_REASON = 200,
};

typedef struct gate_base_row
{
    char name[SUITE_MAX_NAME], variant[SUITE_MAX_VARIANT];
    suite_measurement measured;
} gate_base_row;

/// Why a base was replaced.
typedef struct gate_reason
{
    char date[16]; ///< 2026-01-31
    char text[GATE_MAX_REASON];
} gate_reason;

typedef struct gate_base
{
    char suite[SUITE_MAX_NAME];
    char date[16], version[32];
    char compiler[256]; ///< and flags, of the program that measured: instructions depend on them
    gate_base_row* rows;
    int row_count;
    gate_reason* accepted; ///< [accepted_count] the oldest first
    int accepted_count;
} gate_base;

/// @param out to be released, also after a failure
/// @return WISP_BAD_INPUT no base file, cut or edited, or of another version; WISP_IO_ERROR
wisp_status gate_base_read( const char* path, gate_base* out, wisp_error* error );
/// The same from a text. @param path that messages name
wisp_status gate_base_parse( const char* text, size_t size, const char* path, gate_base* out, wisp_error* error );

/// Replace the file as a whole, or leave it as it was.
wisp_status gate_base_write( const gate_base* base, const char* path, wisp_error* error );
void gate_base_release( gate_base* base );

/// @return null if the base has no such row
const gate_base_row* gate_base_find( const gate_base* base, const suite_row* row );

/// Compiler and flags of this program, as a base has them.
void gate_compiler( char* out, size_t size );

/// Today, as gate_reason has it.
void gate_today( char out[16] );
