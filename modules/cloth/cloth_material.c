// From a definition to the coefficients of links and hinges, in the order of the fabric's schedules.
#include "cloth_internal.h"

#include <math.h>

// Compliance of a constraint that must not act, m/N or 1/J.
static const float NOTHING = 1e12f;

typedef struct vec3d
{
    double x, y, z;
} vec3d;

static vec3d rest_of( const wisp_fabric* f, int slot )
{
    return ( vec3d ){ (double)f->rest[slot].x, (double)f->rest[slot].y, (double)f->rest[slot].z };
}

static vec3d minus( vec3d a, vec3d b )
{
    return ( vec3d ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static double dot( vec3d a, vec3d b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec3d cross( vec3d a, vec3d b )
{
    return ( vec3d ){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static double edge_length( vec3d a )
{
    return sqrt( dot( a, a ) );
}

// ---- links ----

// Square of the cosine between a link of the rest shape and the warp.
static float cosine2( const wisp_fabric* f, int a, int b, wisp_vec3 warp )
{
    vec3d d = minus( rest_of( f, a ), rest_of( f, b ) ), w = { (double)warp.x, (double)warp.y, (double)warp.z };
    double bottom = dot( d, d ) * dot( w, w ), along = dot( d, w );
    return bottom > 0.0 ? (float)( along * along / bottom ) : 1.0f;
}

static float stretch_compliance( const wisp_cloth_def* def, float c2 )
{
    float s2 = 1.0f - c2;
    return def->warp_compliance * c2 * c2 + def->weft_compliance * s2 * s2 + def->shear_compliance * s2 * c2;
}

// 4 sin^2 cos^2 is 0 along the threads and 1 between them.
static float stretch_stiffness( const wisp_cloth_def* def, float c2 )
{
    float between = 4.0f * c2 * ( 1.0f - c2 );
    return def->stretch_stiffness + between * ( def->shear_stiffness - def->stretch_stiffness );
}

static float link_value( const wisp_fabric* f, const wisp_cloth_def* def, int slot )
{
    const bool pbd = def->solver == WISP_SOLVER_PBD;
    int link = f->link_order.constraint[slot];
    if ( link < 0 )
    {
        return 0.0f;
    }
    if ( link < f->edge_count )
    {
        float c2 = cosine2( f, f->link_a_x4[slot] / 4, f->link_b_x4[slot] / 4, def->warp );
        return pbd ? stretch_stiffness( def, c2 ) : stretch_compliance( def, c2 );
    }
    // A bend link without bending must not stretch either: no stiffness, or a very large compliance.
    const bool bends = def->bending == WISP_CLOTH_BENDING_LINKS;
    return pbd ? ( bends ? def->bend_stiffness : 0.0f ) : ( bends ? def->bend_compliance : NOTHING );
}

void cloth_fill_links( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    wisp_component component = def->solver == WISP_SOLVER_PBD ? WISP_LINK_STIFFNESS : WISP_LINK_COMPLIANCE;
    float* column = wisp_world_column( world, surface, component, 0 );
    for ( int slot = 0; slot < f->link_order.slot_count && column != NULL; ++slot )
    {
        column[slot] = link_value( f, def, slot );
    }
}

// ---- coarse sheets ----

// Fills the links of all coarse sheets: each sheet is one of the same material, so its links have the same compliance.
void cloth_fill_levels( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    float* compliance = wisp_world_column( world, surface, WISP_LEVEL_COMPLIANCE, 0 );
    if ( compliance == NULL )
    {
        return;
    }
    *(int32_t*)wisp_world_column( world, surface, WISP_SURFACE_LEVELS, 0 ) = def->coarse_substeps;
    *(int32_t*)wisp_world_column( world, surface, WISP_SURFACE_LEVELS, 1 ) = def->coarse_passes;
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* level = f->levels + l;
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            const int a = level->slot_x4[level->a_x4[i] / 4] / 4, b = level->slot_x4[level->b_x4[i] / 4] / 4;
            const float fraction = level->fraction[i];
            compliance[level->first_link + i] =
                fraction > 0.0f ? stretch_compliance( def, cosine2( f, a, b, def->warp ) ) / fraction : 0.0f;
        }
    }
    wisp_world_restart_levels( world, surface );
}

// ---- hinges ----

typedef struct hinge_shape
{
    vec3d i, j, k, l;
    double edge; // length, m
    bool sound;  // both triangles have an area, so there is an angle between them
} hinge_shape;

static hinge_shape shape_of( const wisp_fabric* f, int hinge )
{
    const int32_t* corner = f->hinges + 4 * (size_t)hinge;
    hinge_shape s = {
        rest_of( f, corner[0] ), rest_of( f, corner[1] ), rest_of( f, corner[2] ), rest_of( f, corner[3] ), 0.0, false
    };
    vec3d e = minus( s.j, s.i );
    double k_area = 0.5 * edge_length( cross( e, minus( s.k, s.i ) ) );
    double l_area = 0.5 * edge_length( cross( e, minus( s.l, s.i ) ) );
    s.edge = edge_length( e );
    s.sound = k_area > 0.0 && l_area > 0.0;
    return s;
}

// The angle as the kernel measures it: positive where the opposite vertices lie on the side of the normals.
static float rest_angle( const hinge_shape* s )
{
    vec3d e = minus( s->j, s->i );
    vec3d n1 = cross( minus( s->k, s->i ), minus( s->k, s->j ) ),
          n2 = cross( minus( s->l, s->j ), minus( s->l, s->i ) );
    double sine = s->edge > 0.0 ? dot( cross( n2, n1 ), e ) / s->edge : 0.0;
    return (float)atan2( sine, dot( n1, n2 ) );
}

// Cotangent of the angle at `at` between the directions to a and b; 0 for a triangle without area.
static double cotangent( vec3d at, vec3d a, vec3d b )
{
    vec3d u = minus( a, at ), v = minus( b, at );
    double bottom = edge_length( cross( u, v ) );
    return bottom > 0.0 ? dot( u, v ) / bottom : 0.0;
}

// The row of Bergou et al. 2006, eq. 4: c . x is the edge's length times the bending, as a vector.
static void bending_row( const hinge_shape* s, double c[4] )
{
    double at_i_k = cotangent( s->i, s->j, s->k ), at_j_k = cotangent( s->j, s->i, s->k );
    double at_i_l = cotangent( s->i, s->j, s->l ), at_j_l = cotangent( s->j, s->i, s->l );
    c[0] = at_j_k + at_j_l;
    c[1] = at_i_k + at_i_l;
    c[2] = -( at_i_k + at_j_k );
    c[3] = -( at_i_l + at_j_l );
}

static void fill_shape( wisp_world* world, wisp_entity surface, const hinge_shape* s, const wisp_cloth_def* def,
                        int slot )
{
    if ( def->bending == WISP_CLOTH_BENDING_DIHEDRAL )
    {
        float* angle = wisp_world_column( world, surface, WISP_HINGE_REST, 0 );
        angle[slot] = s->sound ? rest_angle( s ) : 0.0f;
        return;
    }
    float* weight = wisp_world_column( world, surface, WISP_HINGE_COTANGENT, 0 );
    double c[4] = { 0 };
    if ( s->sound )
    {
        bending_row( s, c );
    }
    for ( int k = 0; k < 4; ++k )
    {
        weight[( slot / 8 ) * 32 + 8 * k + slot % 8] = (float)c[k];
    }
}

void cloth_fill_hinges( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    float* stiffness = wisp_world_column( world, surface, WISP_HINGE_STIFFNESS, 0 );
    for ( int slot = 0; slot < f->hinge_order.slot_count; ++slot )
    {
        const int hinge = f->hinge_order.constraint[slot];
        const hinge_shape s = hinge >= 0 ? shape_of( f, hinge ) : ( hinge_shape ){ 0 };
        fill_shape( world, surface, &s, def, slot );
        if ( stiffness != NULL )
        {
            stiffness[slot] = s.sound ? def->bend_stiffness : 0.0f;
        }
    }
}
