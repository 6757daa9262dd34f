/// The parts of the reader of suites.
#pragma once

#include "scene_text.h"
#include "suite.h"
#include "text_tree.h"

enum
{
    SUITE_MAX_SETTINGS = 16, ///< that vary in an entry
    SUITE_MAX_BYTES = 1 << 20,
};

typedef struct suite_reader
{
    scene_source source;
    text_node* tree;
    wisp_suite* out;
    const suite_given* given;                 ///< the scene of all rows; null: their files
    int capacity;                             ///< rows
    suite_budget budgets[SUITE_BUDGET_COUNT]; ///< of all entries
    const text_node* seconds;                 ///< of all entries; null: none
    const text_node* axes;                    ///< maps of bundles by name, for `sweep`; null: none
    unsigned checks;                          ///< of all entries
    stability_limits limits;                  ///< of their checks
} suite_reader;

/// Fail with the place of a node. @return WISP_BAD_INPUT
wisp_status suite_refuse( const suite_reader* r, const text_node* node, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );

/// Find the values of a block's keys. @param values [count] receives them; null where the block has none
/// @return WISP_BAD_INPUT it is no block, or has another key (the message suggests one); `expected` says what it should be
wisp_status suite_take_keys( const suite_reader* r, const text_node* block, const char* expected,
                             const char* const* keys, int count, const text_node** values );

/// @param budgets [SUITE_BUDGET_COUNT] those that the block names are changed
wisp_status suite_read_budgets( const suite_reader* r, const text_node* block, suite_budget* budgets );

/// Add the rows of an entry of `scenes`.
wisp_status suite_read_entry( suite_reader* r, const text_node* block );

/// Check that `axes` are maps of bundles.
wisp_status suite_check_axes( const suite_reader* r );

/// A run of a scene that a reference is made of.
typedef struct suite_run
{
    const text_node* file;          ///< of the scene; null: that of the first row
    const text_node *set, *coarser; ///< fields, and those of a coarser run; null: none
    int substeps;                   ///< 0: those of the scene
    const suite_row* of;            ///< row whose scene and length it has, in place of a file's; null: none
} suite_run;

/// Read a run. That of a file is as long as the first row unless the suite has `seconds`.
wisp_status suite_read_run( const suite_reader* r, const suite_run* run, const char* name, suite_row* out );

/// The path of a file that a suite names; for free().
char* suite_resolve( const suite_reader* r, const char* file );
/// @return NaN: no number
double suite_number_of( const text_node* node );

/// The name of a file without folder and extension, cut to the size.
void suite_stem( const char* path, char* out, size_t size );

// ---- checks ----

/// Read `checks`: words, those of them that are given a limit, or `all`.
wisp_status suite_read_checks( const suite_reader* r, const text_node* node, unsigned* out,
                               stability_limits* limits );
/// Read `expect`.
wisp_status suite_read_expect( const suite_reader* r, const text_node* node, bool* is_refused );
/// Read `known`, `quick` and `long`, after the entries: they name rows. Any may be null.
wisp_status suite_mark_rows( const suite_reader* r, const text_node* known, const text_node* quick,
                             const text_node* slow );
