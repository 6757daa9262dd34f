// The block `reference` of a suite: what it says, and the runs that it asks for.
#include "suite_reader.h"

#include <string.h>

enum
{
    REFERENCE_START,
    REFERENCE_OVERLAP,
    REFERENCE_STORED,
    REFERENCE_DOUBT,
    REFERENCE_FILE,
    REFERENCE_EXTRAPOLATE,
    REFERENCE_SET,
    REFERENCE_CHECK,
    REFERENCE_COUNT,
};

static const char* const reference_keys[REFERENCE_COUNT] = { "start", "overlap",     "stored", "doubt",
                                                             "file",  "extrapolate", "set",    "check" };

// A half and a quarter of the substeps of the reference.
static wisp_status read_halves( const suite_reader* r, suite_run run, const scene_node* place )
{
    wisp_scene scene;
    wisp_status status = suite_scene( &r->out->reference, &scene, r->source.error );
    const int substeps = scene.substeps;
    wisp_scene_release( &scene );
    if ( status == WISP_OK && substeps % 4 != 0 )
    {
        return suite_refuse( r, place, "got a reference of %d substeps, expected a multiple of 4 to extrapolate from",
                             substeps );
    }
    run.substeps = substeps / 2;
    status = status == WISP_OK ? suite_read_run( r, &run, "reference, half", &r->out->check ) : status;
    run.substeps = substeps / 4;
    return status == WISP_OK ? suite_read_run( r, &run, "reference, quarter", &r->out->coarsest ) : status;
}

// A reference is finer than what is measured with it, also where entities have substeps of their own.
static wisp_status check_own_substeps( const suite_reader* r, const scene_node* place )
{
    wisp_scene scene;
    wisp_status status = suite_scene( &r->out->reference, &scene, r->source.error );
    const int own = wisp_scene_own_substeps( &scene ), substeps = scene.substeps;
    wisp_scene_release( &scene );
    return status == WISP_OK && own > 0 && 4 * (int64_t)own > substeps
               ? suite_refuse( r, place,
                               "got a reference of %d substeps and an entity with %d of its own, expected at least "
                               "four times as many",
                               substeps, own )
               : status;
}

// All runs are as long as the first row.
static wisp_status read_runs( const suite_reader* r, const scene_node* block, const scene_node* const* values )
{
    suite_run run = { .file = values[REFERENCE_FILE], .set = values[REFERENCE_SET] };
    wisp_status status = suite_read_run( r, &run, "reference", &r->out->reference );
    status =
        status == WISP_OK ? check_own_substeps( r, values[REFERENCE_SET] ? values[REFERENCE_SET] : block ) : status;
    if ( status == WISP_OK && values[REFERENCE_EXTRAPOLATE] )
    {
        return read_halves( r, run, values[REFERENCE_EXTRAPOLATE] );
    }
    run.coarser = values[REFERENCE_CHECK];
    return status == WISP_OK ? suite_read_run( r, &run, "reference, check", &r->out->check ) : status;
}

wisp_status suite_read_reference( suite_reader* r, const scene_node* block )
{
    const scene_node* values[REFERENCE_COUNT];
    const wisp_status status =
        suite_take_keys( r, block, "a reference, such as { set: { substeps: 320 }, check: { substeps: 160 } }",
                         reference_keys, REFERENCE_COUNT, values );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int i = 0; i < REFERENCE_COUNT; ++i )
    {
        const bool is_text = i <= REFERENCE_EXTRAPOLATE;
        if ( values[i] && values[i]->kind != ( is_text ? SCENE_SCALAR : SCENE_MAP ) )
        {
            return suite_refuse( r, values[i], "expected %s",
                                 is_text ? "a text or a number"
                                         : "fields and their values, such as { substeps: 320 }" );
        }
    }
    r->out->compares_start = values[REFERENCE_START] != NULL;
    if ( r->out->compares_start )
    {
        return strcmp( scene_text_of( &r->tree, values[REFERENCE_START] ), "true" ) == 0 && block->count == 1
                   ? WISP_OK
                   : suite_refuse( r, block, "expected start: true alone" );
    }
    r->out->compares_overlap = values[REFERENCE_OVERLAP] != NULL;
    if ( r->out->compares_overlap )
    {
        return strcmp( scene_text_of( &r->tree, values[REFERENCE_OVERLAP] ), "none" ) == 0 && block->count == 1
                   ? WISP_OK
                   : suite_refuse( r, block, "expected overlap: none alone" );
    }
    const scene_node* order = values[REFERENCE_EXTRAPOLATE];
    r->out->extrapolate = order ? suite_number_of( r, order ) : 0.0;
    if ( order && r->out->extrapolate != 1.0 && r->out->extrapolate != 2.0 )
    {
        return suite_refuse( r, order, "got extrapolate '%s', expected the order at which the runs converge, 1 or 2",
                             scene_shorten( scene_text_of( &r->tree, order ) ).text );
    }
    if ( order && ( values[REFERENCE_STORED] || values[REFERENCE_CHECK] ) )
    {
        return suite_refuse( r, order, "got extrapolate with %s, expected one of them",
                             values[REFERENCE_STORED] ? "stored" : "check" );
    }
    if ( values[REFERENCE_STORED] )
    {
        r->out->stored = suite_resolve( r, scene_text_of( &r->tree, values[REFERENCE_STORED] ) );
        r->out->stored_doubt = values[REFERENCE_DOUBT] ? suite_number_of( r, values[REFERENCE_DOUBT] ) : 0.0;
        return r->out->stored_doubt >= 0.0 ? WISP_OK
                                           : suite_refuse( r, values[REFERENCE_DOUBT], "expected a distance in m" );
    }
    if ( values[REFERENCE_SET] == NULL || ( values[REFERENCE_CHECK] == NULL && order == NULL ) )
    {
        return suite_refuse( r, block,
                             "expected set, the fields of the converged run, and check, those that make a coarser "
                             "one, or extrapolate, the order at which runs converge" );
    }
    return read_runs( r, block, values );
}
