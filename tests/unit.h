/// Included by every test file: cmocka with the headers that it needs, the usual ones of the C library, and cases that
/// register themselves for the main() of unit_main.c.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Folder of the tree, for tests that read its files.
#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

// ---- cases ----

/// A case in the list of main().
typedef struct unit_case
{
    struct CMUnitTest test; ///< without a function: the fixture of all cases of the file
    const char* file;       ///< where it is defined
    int place;              ///< in that file
    struct unit_case* next;
} unit_case;

/// Take the arguments of the program. @return false if they are wrong
typedef bool unit_arguments_fn( int argc, char** argv );
/// @return why no case can run here, or NULL
typedef const char* unit_obstacle_fn( void );

void unit_add_case( unit_case* added );
void unit_set_arguments( unit_arguments_fn* take );
void unit_set_obstacle( unit_obstacle_fn* find );

/// Define a case: TEST( name ) { ... }. The cases of a file run in their order there; `state` is that of the fixture.
#define TEST( name ) TEST_WITH( name, NULL, NULL )

/// Define a case with a fixture of its own. Either function may be NULL.
#define TEST_WITH( name, set_up, tear_down )                                                                         \
    static void name( void** state );                                                                                \
    TEST_BEFORE_MAIN( name )                                                                                         \
    {                                                                                                                \
        static unit_case added = { { #name, name, set_up, tear_down, NULL }, __BASE_FILE__, __COUNTER__, NULL };     \
        unit_add_case( &added );                                                                                     \
    }                                                                                                                \
    static void name( __attribute__( ( unused ) ) void** state )

/// Name the fixture of all cases of the file together.
#define TEST_GROUP( set_up, tear_down )                                                                              \
    TEST_BEFORE_MAIN( group )                                                                                        \
    {                                                                                                                \
        static unit_case added = { { NULL, NULL, set_up, tear_down, NULL }, __BASE_FILE__, __COUNTER__, NULL };      \
        unit_add_case( &added );                                                                                     \
    }

/// Name the function that takes the arguments. If it returns false, the exit status is 64.
#define TEST_ARGUMENTS( take )                                                                                       \
    TEST_BEFORE_MAIN( arguments )                                                                                    \
    {                                                                                                                \
        unit_set_arguments( take );                                                                                  \
    }

/// Name the function that says why all cases are skipped.
#define TEST_OBSTACLE( find )                                                                                        \
    TEST_BEFORE_MAIN( obstacle )                                                                                     \
    {                                                                                                                \
        unit_set_obstacle( find );                                                                                   \
    }

/// End the case here. `./dev test` lists the reasons, a string each.
#define SKIP( why )                                                                                                  \
    do                                                                                                               \
    {                                                                                                                \
        print_message( "skipped: %s\n", why );                                                                       \
        skip();                                                                                                      \
    } while ( 0 )

#define TEST_BEFORE_MAIN( name ) __attribute__( ( constructor ) ) static void register_##name( void )

// ---- what a case gives back ----

/// Release a local at the end of its block, in the reverse order of declarations: SCOPED( close_world ) hosted h;
/// The function takes a pointer to the local. A case that fails releases nothing.
#define SCOPED( release ) __attribute__( ( cleanup( release ) ) )

/// For locals that point to a block. @param local address of the pointer
static inline void free_local( void* local )
{
    void* block;
    memcpy( &block, local, sizeof( block ) );
    free( block );
}

// ---- checked allocation ----

static inline void* checked_malloc( size_t size )
{
    void* memory = malloc( size );
    assert_non_null( memory );
    return memory;
}

static inline void* checked_calloc( size_t count, size_t size )
{
    void* memory = calloc( count, size );
    assert_non_null( memory );
    return memory;
}

// ---- messages ----

/// The call must succeed; `error` is its wisp_error.
#define assert_ok( status, error )                                                                                   \
    do                                                                                                               \
    {                                                                                                                \
        if ( ( status ) != WISP_OK )                                                                                 \
        {                                                                                                            \
            fail_msg( "%s", ( error ).message );                                                                     \
        }                                                                                                            \
    } while ( 0 )

/// A text, which may be null, contains these words.
static inline void assert_contains( const char* text, const char* words )
{
    if ( text == NULL || strstr( text, words ) == NULL )
    {
        fail_msg( "expected \"%s\" in:\n%s", words, text == NULL ? "nothing at all" : text );
    }
}
