// Calls of the host on strands with a definition: wind, gravity, and what they read.
#include "strands_definition.h"

#include "rod_factors.h"
#include "strand_rows.h"

wisp_status wisp_set_strand_wind( wisp_world* world, wisp_entity strands, wisp_vec3 wind )
{
    WISP_TRY( wisp_world_check_entity( world, strands ) );
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    WISP_TRY( strands_check_vector( world, "wind", wind, 1e5f ) );
    if ( wisp_world_has( world, strands, s->air ) == false )
    {
        const wisp_strand_dynamics_def usual = wisp_default_strand_dynamics_def();
        WISP_TRY( wisp_world_attach( world, strands, s->air ) );
        *(strands_air*)wisp_world_column( world, strands, s->air, 0 ) =
            ( strands_air ){ .drag = 0.5f * usual.air_density * usual.diameter };
    }
    strands_air* air = wisp_world_column( world, strands, s->air, 0 );
    air->wind = wind;
    return WISP_OK;
}

wisp_status wisp_set_strand_gravity( wisp_world* world, wisp_entity strands, wisp_vec3 gravity )
{
    WISP_TRY( wisp_world_check_entity( world, strands ) );
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    WISP_TRY( strands_check_vector( world, "gravity", gravity, 1e5f ) );
    strands_settings* settings = wisp_world_column( world, strands, s->settings, 0 );
    settings->gravity = gravity;
    return WISP_OK;
}

wisp_status wisp_read_strand_tension( wisp_world* world, wisp_entity strands, float* tensions )
{
    WISP_TRY( wisp_world_check_entity( world, strands ) );
    WISP_TRY( wisp_world_check_pointer( world, "tensions", tensions ) );
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    if ( wisp_world_has( world, strands, s->direct ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: entity %u does not stretch by the direct solve",
                                strands.index );
    }
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* tension = wisp_world_column( world, strands, s->tension, 0 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            const float value = tension[strands_scalar( t->group_row[i / WISP_LANES] + v, i % WISP_LANES )];
            tensions[t->offsets[t->lane_strand[i]] + v] = v + 1 < t->lane_count[i] ? value : 0.0f;
        }
    }
    return WISP_OK;
}

static double length_of( const wisp_strand_topology* t, const float* length, int lane )
{
    double sum = 0.0;
    for ( int v = 0; v + 1 < t->lane_count[lane]; ++v )
    {
        sum += (double)length[strands_scalar( t->group_row[lane / WISP_LANES] + v, lane % WISP_LANES )];
    }
    return sum;
}

wisp_status wisp_read_strand_hold( wisp_world* world, wisp_entity strands, wisp_strand_hold* out )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    *out = ( wisp_strand_hold ){ 0 };
    WISP_TRY( wisp_world_check_entity( world, strands ) );
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    if ( wisp_world_has( world, strands, s->rod ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: entity %u does not bend as rods", strands.index );
    }
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const strands_rows rows = strands_rows_of( world, strands );
    const float* balanced = wisp_world_column( world, strands, s->balance, 0 );
    const float* held = wisp_world_column( world, strands, s->balance, 2 );
    const strands_settings* settings = wisp_world_column( world, strands, s->settings, 0 );
    const strands_section* section = wisp_world_column( world, strands, s->section, 0 );
    const double flat = section != NULL ? (double)section->flatness : 0.0;
    const double rigidity = (double)settings->bend_rigidity * ( 1.0 - flat * flat );
    *out = ( wisp_strand_hold ){ .bend_rigidity = (float)rigidity };
    double least = 2.0;
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const bool is_known = balanced != NULL && balanced[i / WISP_LANES] != 0.0f;
        const double own = is_known ? (double)held[i] : 1.0;
        if ( t->lane_count[i] > 1 && own < least )
        {
            least = own;
            out->max_length = (float)( cbrt( own ) * length_of( t, rows.length, i ) );
            out->bend_rigidity = (float)( rigidity / own );
        }
        out->sagging += t->lane_count[i] > 1 && own < 1.0 ? 1 : 0;
    }
    return WISP_OK;
}
