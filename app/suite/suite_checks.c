// What must be true of rows, and which of them are known to break it.
#include "suite_reader.h"

#include "nearest.h"
#include "stability_judges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Those that a run of a scene can break; the rest is of the search for scenes that do.
static const stability_check words[] = { STABILITY_STATUS, STABILITY_FINITE,      STABILITY_HALTED,
                                         STABILITY_ENERGY, STABILITY_STRAIN,      STABILITY_RECOVERY,
                                         STABILITY_SPEED,  STABILITY_PENETRATION, STABILITY_INTERSECTIONS,
                                         STABILITY_REST,   STABILITY_BITS };

static wisp_status read_word( const suite_reader* r, const scene_node* node, int* out )
{
    const char* names[WISP_COUNT( words )];
    char all[160] = "";
    const char* text = node->kind == SCENE_SCALAR ? scene_text_of( &r->tree, node ) : "";
    for ( int i = 0; i < WISP_COUNT( words ); ++i )
    {
        names[i] = stability_check_names[words[i]];
        strncat( all, i > 0 ? ", " : "", sizeof all - strlen( all ) - 1 );
        strncat( all, names[i], sizeof all - strlen( all ) - 1 );
        if ( strcmp( text, names[i] ) == 0 )
        {
            *out = words[i];
            return WISP_OK;
        }
    }
    const scene_quote quote = scene_shorten( text );
    const char* nearest = nearest_word( quote.text, names, WISP_COUNT( words ) );
    return nearest ? suite_refuse( r, node, "got check '%s'; did you mean '%s'?", quote.text, nearest )
                   : suite_refuse( r, node, "got check '%s', expected one of %s", quote.text, all );
}

static bool is_all( const suite_reader* r, const scene_node* node )
{
    return node->kind == SCENE_SCALAR && strcmp( scene_text_of( &r->tree, node ), "all" ) == 0;
}

static unsigned all_checks( void )
{
    unsigned all = 0;
    for ( int i = 0; i < WISP_COUNT( words ); ++i )
    {
        all |= stability_bit( words[i] );
    }
    return all;
}

// A check and its limit, such as { strain: 0.1 }.
static wisp_status read_limit( const suite_reader* r, const scene_node* map, int* out, stability_limits* limits )
{
    const scene_node* n = scene_first( &r->tree, map );
    const struct
    {
        stability_check check;
        double* limit;
    } all[] = { { STABILITY_STRAIN, &limits->strain },
                { STABILITY_ENERGY, &limits->energy },
                { STABILITY_SPEED, &limits->speed },
                { STABILITY_REST, &limits->rest } };
    for ( int i = 0; i < WISP_COUNT( all ) && map->count == 1; ++i )
    {
        if ( strcmp( scene_key_of( &r->tree, n ), stability_check_names[all[i].check] ) == 0 )
        {
            char* end = NULL;
            const char* text = n->kind == SCENE_SCALAR ? scene_text_of( &r->tree, n ) : "";
            *all[i].limit = strtod( text, &end );
            *out = all[i].check;
            return end != text && *end == '\0' && *all[i].limit > 0.0 && isfinite( *all[i].limit )
                       ? WISP_OK
                       : suite_refuse( r, n, "expected a limit above 0" );
        }
    }
    return suite_refuse( r, map,
                         "expected a check and its limit, one of strain, energy, speed and rest, such as "
                         "{ strain: 0.1 }" );
}

wisp_status suite_read_checks( const suite_reader* r, const scene_node* node, unsigned* out,
                               stability_limits* limits )
{
    *out = 0;
    *limits = ( stability_limits ){ 0 };
    if ( is_all( r, node ) )
    {
        *out = all_checks();
        return WISP_OK;
    }
    if ( node->kind != SCENE_LIST || node->count == 0 )
    {
        return suite_refuse( r, node,
                             "expected checks: all, or a list of checks such as [finite, energy, { strain: 0.1 }]" );
    }
    wisp_status status = WISP_OK;
    for ( const scene_node* n = scene_first( &r->tree, node ); n && status == WISP_OK; n = scene_next( &r->tree, n ) )
    {
        int check = 0;
        if ( is_all( r, n ) )
        {
            *out |= all_checks();
            continue;
        }
        status = n->kind == SCENE_MAP ? read_limit( r, n, &check, limits ) : read_word( r, n, &check );
        *out |= stability_bit( (stability_check)check );
    }
    return status;
}

wisp_status suite_read_expect( const suite_reader* r, const scene_node* node, bool* is_refused )
{
    *is_refused = node->kind == SCENE_SCALAR && strcmp( scene_text_of( &r->tree, node ), "refused" ) == 0;
    return *is_refused ? WISP_OK : suite_refuse( r, node, "expected expect: refused" );
}

void suite_label( const suite_row* row, char out[SUITE_MAX_LABEL] )
{
    snprintf( out, SUITE_MAX_LABEL, "%s%s%s", row->name, row->variant[0] ? ": " : "", row->variant );
}

// A label, or what varies alone.
static bool is_meant( const suite_row* row, const char* text )
{
    char label[SUITE_MAX_LABEL];
    suite_label( row, label );
    return strcmp( label, text ) == 0 || ( row->variant[0] && strcmp( row->variant, text ) == 0 );
}

static wisp_status mark_known( const suite_reader* r, const scene_node* node )
{
    const char* text = scene_key_of( &r->tree, node );
    int check = 0, count = 0;
    const wisp_status status = read_word( r, node, &check );
    for ( int i = 0; i < r->out->row_count && status == WISP_OK; ++i )
    {
        suite_row* row = &r->out->rows[i];
        if ( is_meant( row, text ) )
        {
            row->known = check;
            ++count;
            if ( ( row->checks & stability_bit( (stability_check)check ) ) == 0 )
            {
                return suite_refuse( r, node, "'%s' is known to break %s, which is none of its checks",
                                     scene_shorten( text ).text, stability_check_names[check] );
            }
        }
    }
    return status != WISP_OK || count > 0 ? status
                                          : scene_refuse( &r->source, node->key_line, node->key_column, "",
                                                          "no row is called '%s'", scene_shorten( text ).text );
}

static wisp_status mark_list( const suite_reader* r, const scene_node* list, bool is_long )
{
    if ( list->kind != SCENE_LIST )
    {
        return suite_refuse( r, list, "expected a list of rows" );
    }
    for ( int i = 0; i < r->out->row_count && !is_long; ++i )
    {
        r->out->rows[i].is_slow = true;
    }
    for ( const scene_node* n = scene_first( &r->tree, list ); n; n = scene_next( &r->tree, n ) )
    {
        int count = 0;
        const char* text = n->kind == SCENE_SCALAR ? scene_text_of( &r->tree, n ) : "";
        for ( int i = 0; i < r->out->row_count; ++i )
        {
            suite_row* row = &r->out->rows[i];
            if ( is_meant( row, text ) )
            {
                row->is_long = row->is_long || is_long;
                row->is_slow = row->is_slow && is_long;
                ++count;
            }
        }
        if ( count == 0 )
        {
            return suite_refuse( r, n, "no row is called '%s'", scene_shorten( text ).text );
        }
    }
    return WISP_OK;
}

wisp_status suite_mark_rows( const suite_reader* r, const scene_node* known, const scene_node* quick,
                             const scene_node* slow )
{
    wisp_status status = WISP_OK;
    if ( known && known->kind != SCENE_MAP )
    {
        return suite_refuse( r, known,
                             "expected rows and the checks that they break, such as { \"sheet\": strain }" );
    }
    for ( const scene_node* n = known ? scene_first( &r->tree, known ) : NULL; n && status == WISP_OK;
          n = scene_next( &r->tree, n ) )
    {
        status = mark_known( r, n );
    }
    status = status == WISP_OK && quick ? mark_list( r, quick, false ) : status;
    return status == WISP_OK && slow ? mark_list( r, slow, true ) : status;
}
