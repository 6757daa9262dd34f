/// Scenes as text for tests of the search.
#pragma once

#include "unit.h"

#include "torture_twins.h"

static inline text_node* parse_scene( const char* text )
{
    text_node* tree;
    wisp_error error = { 0 };
    assert_ok( text_parse( text, strlen( text ), "test", &tree, &error ), error );
    return tree;
}

/// Judge a text with all twins, or without.
static inline stability_verdict judge_text( const char* text, int twins )
{
    text_node* tree = parse_scene( text );
    const torture_subject subject = { tree, "test" };
    const stability_verdict verdict = torture_judge_scene( &subject, twins, 60.0 );
    text_release( tree );
    return verdict;
}

static inline void assert_judged( stability_verdict verdict, stability_check judge )
{
    if ( verdict.check != judge )
    {
        fail_msg( "got %s (%s), expected %s", verdict.check < 0 ? "nothing" : stability_check_names[verdict.check],
                  verdict.message, judge < 0 ? "nothing" : stability_check_names[judge] );
    }
}
