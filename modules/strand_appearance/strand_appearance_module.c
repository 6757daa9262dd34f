#include "strand_appearance.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

static const wisp_column_def SETTINGS_COLUMNS[] = { WISP_COLUMN( wisp_strand_appearance_def, settings, 1 ) };

typedef struct look_state
{
    wisp_component settings;
} look_state;

static const wisp_field STRAND_APPEARANCE_FIELDS[] = {
    WISP_NUMBER( wisp_strand_appearance_def, root_width, 80e-6, 0, 1, "m" ),
    WISP_NUMBER( wisp_strand_appearance_def, tip_width, 20e-6, 0, 1, "m" ),
    WISP_POINT( wisp_strand_appearance_def, root_colour, 0, 1, NULL, 0.12, 0.07, 0.04 ),
    WISP_POINT( wisp_strand_appearance_def, tip_colour, 0, 1, NULL, 0.30, 0.15, 0.07 ),
    WISP_NUMBER( wisp_strand_appearance_def, colour_bias, 0.5, 1e-3, 0.999, NULL ),
};
WISP_DEFINE( strand_appearance_def, "strand appearance", STRAND_APPEARANCE_FIELDS )

static void appearance_at( const wisp_strand_appearance_def* def, float t, float* width, wisp_vec3* colour )
{
    if ( width != NULL )
    {
        *width = def->root_width + t * ( def->tip_width - def->root_width );
    }
    if ( colour != NULL )
    {
        const wisp_vec3 a = def->root_colour, b = def->tip_colour;
        const float w = t / ( ( 1.0f / def->colour_bias - 2.0f ) * ( 1.0f - t ) + 1.0f );
        *colour = ( wisp_vec3 ){ a.x + w * ( b.x - a.x ), a.y + w * ( b.y - a.y ), a.z + w * ( b.z - a.z ) };
    }
}

void wisp_strand_appearance_at( const wisp_strand_appearance_def* given, float t, float* width, wisp_vec3* colour )
{
    wisp_strand_appearance_def def;
    (void)wisp_def_read( &wisp_strand_appearance_def_fields, &def, given, NULL ); // else the defaults
    appearance_at( &def, t, width, colour );
}

// t from root 0 to tip 1; a strand of one vertex is all root.
static float along( int vertex, int count )
{
    return count > 1 ? (float)vertex / (float)( count - 1 ) : 0.0f;
}

static void paint_width( wisp_frame* frame, const wisp_span* span, void* user )
{
    const look_state* state = user;
    const wisp_strand_appearance_def* d = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    float* width = wisp_frame_column( frame, span->entity, WISP_POINT_WIDTH, 0 );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            appearance_at( d, along( v, t->lane_count[i] ), &width[t->offsets[t->lane_strand[i]] + v], NULL );
        }
    }
}

static void paint_colour( wisp_frame* frame, const wisp_span* span, void* user )
{
    const look_state* state = user;
    const wisp_strand_appearance_def* d = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_vec3* colour = wisp_frame_column( frame, span->entity, WISP_POINT_COLOUR, 0 );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            appearance_at( d, along( v, t->lane_count[i] ), NULL, &colour[t->offsets[t->lane_strand[i]] + v] );
        }
    }
}

static wisp_status declare( wisp_registry* r )
{
    look_state* state = wisp_declare_state( r, sizeof( look_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->settings = WISP_COMPONENT( r, "strand_appearance.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS );
    wisp_pass pass = {
        WISP_PASS( "strand_appearance.width", OBSERVE, STRAND_GROUP, paint_width ),
        .required = { state->settings },
        .reads = { state->settings },
        .writes = { WISP_POINT_WIDTH },
        .detail = WISP_PASS_WITHOUT_MOTION,
        .on_change = state->settings,
        .user = state,
    };
    wisp_status status = wisp_declare_pass( r, &pass );
    pass.name = "strand_appearance.colour";
    pass.writes[0] = WISP_POINT_COLOUR;
    pass.run = paint_colour;
    return status == WISP_OK ? wisp_declare_pass( r, &pass ) : status;
}

const wisp_module wisp_strand_appearance_module = { .name = "strand_appearance", .declare = declare };

// ---- parameters ----

wisp_status wisp_set_strand_appearance( wisp_world* world, wisp_entity strands,
                                        const wisp_strand_appearance_def* given )
{
    wisp_strand_appearance_def values;
    const wisp_strand_appearance_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &strands, &wisp_strand_appearance_def_fields, &values, given ) );
    WISP_FIND_STATE( const look_state, state, world, "strand_appearance", &strands, WISP_IS_STRANDS );
    return wisp_world_set_row( world, strands, state->settings, def, sizeof( *def ) );
}
