/// Included by every test file: cmocka with the headers that it needs, and the usual ones of the C library.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Folder of the tree, for tests that read its files.
#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

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
