/// Scenes as text for tests of the search.
#pragma once

#include "unit.h"

#include "torture_judges.h"

static inline text_node* parse_scene( const char* text )
{
    text_node* tree;
    wisp_error error = { 0 };
    assert_ok( text_parse( text, strlen( text ), "test", &tree, &error ), error );
    return tree;
}

/// Judge a text with all twins, or without.
static inline torture_verdict judge_text( const char* text, int twins )
{
    text_node* tree = parse_scene( text );
    const torture_subject subject = { tree, "test" };
    const torture_verdict verdict = torture_judge_scene( &subject, twins, 60.0 );
    text_release( tree );
    return verdict;
}

static inline void assert_judged( torture_verdict verdict, torture_judge judge )
{
    if ( verdict.judge != judge )
    {
        fail_msg( "got %s (%s), expected %s", verdict.judge < 0 ? "nothing" : torture_judge_names[verdict.judge],
                  verdict.message, judge < 0 ? "nothing" : torture_judge_names[judge] );
    }
}
