// Generated meshes: checks of a definition, and the planes that are grids. Only + - * /, square roots, the engine's
// own sine and counter-based random numbers: the same definition gives the same bits with every compiler and C
// library.
#include "mesh_internal.h"

#include <math.h>

#include "wisp/generate.h"
#include "wisp/module/definition.h"

enum
{
    MAX_LEVEL = 10,
    MIN_GARMENT = 64, // vertices: its corners alone are 21
};

static const float LARGEST_SIZE = 1e6f;   // m, the same limit as for a groom
static const float SMALLEST_SIZE = 1e-6f; // m
static const float MAX_JITTER = 0.2f;     // more can turn a triangle over before the flips begin
static const float MAX_SLENDER = 1e3f;    // of one side of a Delaunay piece to the other

wisp_mesh_generator wisp_default_mesh_generator( wisp_mesh_shape shape )
{
    bool is_torus = shape == WISP_MESH_TORUS, is_garment = shape == WISP_MESH_GARMENT;
    return ( wisp_mesh_generator ){
        .shape = shape,
        .columns = 32,
        .rows = 32,
        .vertex_count = is_garment || shape == WISP_MESH_DELAUNAY ? 958 : 0,
        .level = 4,
        .segments = is_torus ? 64 : 48,
        .rings = is_torus                     ? 32
                 : shape == WISP_MESH_CAPSULE ? 12
                                              : 24,
        .length_segments = 24,
        .spacing = 0.02f,
        .jitter = 0.2f,
        .radius = 0.5f,
        .tube_radius = 0.2f,
        .length = 1.0f,
        .width = is_garment ? 0.55f : 1.0f,
        .depth = is_garment ? 0.7f : 1.0f,
        .seed = 1,
    };
}

// ---- checks ----------------------------------------------------------------------------------------------------

static wisp_status check_shape( const wisp_mesh_generator* r, wisp_error* error )
{
    int shape = (int)r->shape;
    return shape >= 0 && shape < WISP_MESH_SHAPE_COUNT
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "mesh generator: shape: got %d, expected 0 .. %d", shape,
                            WISP_MESH_SHAPE_COUNT - 1 );
}

static bool is_plane( const wisp_mesh_generator* r )
{
    return r->shape == WISP_MESH_PLANE_REGULAR || r->shape == WISP_MESH_PLANE_ALTERNATING ||
           r->shape == WISP_MESH_PLANE_IRREGULAR;
}

static bool is_delaunay( const wisp_mesh_generator* r )
{
    return r->shape == WISP_MESH_DELAUNAY || r->shape == WISP_MESH_GARMENT;
}

static bool has_level( const wisp_mesh_generator* r )
{
    return r->shape == WISP_MESH_ICOSPHERE || r->shape == WISP_MESH_PEAR;
}

static bool has_length( const wisp_mesh_generator* r )
{
    return r->shape == WISP_MESH_CAPSULE || r->shape == WISP_MESH_TUBE;
}

static wisp_status check_counts( const wisp_mesh_generator* r, wisp_error* error )
{
    bool plane = is_plane( r ), turned = !plane && !is_delaunay( r ) && !has_level( r );
    bool counted = is_delaunay( r ) || ( r->shape == WISP_MESH_PLANE_IRREGULAR && r->vertex_count != 0 );
    int min_vertices = r->shape == WISP_MESH_GARMENT ? MIN_GARMENT : 4;
    int min_rings = r->shape == WISP_MESH_TORUS ? 3 : r->shape == WISP_MESH_UV_SPHERE ? 2 : 1;
    const struct
    {
        const char* name;
        bool used;
        int value, least, most;
    } values[] = {
        { "columns", plane, r->columns, 2, WISP_MESH_VERTEX_CAP },
        { "rows", plane, r->rows, 2, WISP_MESH_VERTEX_CAP },
        { "vertex count", counted, r->vertex_count, min_vertices, WISP_MESH_VERTEX_CAP },
        { "level", has_level( r ), r->level, 0, MAX_LEVEL },
        { "segments", turned, r->segments, 3, WISP_MESH_VERTEX_CAP },
        { "rings", turned && r->shape != WISP_MESH_TUBE, r->rings, min_rings, WISP_MESH_VERTEX_CAP },
        { "length segments", has_length( r ), r->length_segments, 1, WISP_MESH_VERTEX_CAP },
    };
    for ( int i = 0; i < WISP_COUNT( values ); ++i )
    {
        if ( values[i].used && ( values[i].value < values[i].least || values[i].value > values[i].most ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "mesh generator: %s: got %d, expected %d .. %d", values[i].name,
                              values[i].value, values[i].least, values[i].most );
        }
    }
    return WISP_OK;
}

// Products of counts that were checked one by one fit 64 bits.
static wisp_status check_product( const wisp_mesh_generator* r, wisp_error* error )
{
    if ( is_delaunay( r ) || has_level( r ) )
    {
        return WISP_OK;
    }
    int64_t across = is_plane( r ) ? r->columns : r->segments;
    int64_t along = is_plane( r ) ? r->rows : r->rings;
    along += r->shape == WISP_MESH_CAPSULE ? (int64_t)r->rings + r->length_segments : 0;
    along = r->shape == WISP_MESH_TUBE ? (int64_t)r->length_segments + 1 : along;
    if ( across * along > WISP_MESH_VERTEX_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "mesh generator: got %lld times %lld vertices, expected at most %d",
                          (long long)across, (long long)along, WISP_MESH_VERTEX_CAP );
    }
    // Every row of an irregular plane keeps its two corners or border vertices.
    if ( r->shape == WISP_MESH_PLANE_IRREGULAR && r->vertex_count != 0 &&
         ( r->vertex_count / r->rows < 2 || r->vertex_count > 2 * (int64_t)r->columns * r->rows ||
           2 * (int64_t)r->vertex_count < (int64_t)r->columns * r->rows ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "mesh generator: vertex count: got %d, expected half to twice of %d columns times %d rows",
                          r->vertex_count, r->columns, r->rows );
    }
    return WISP_OK;
}

static wisp_status check_sizes( const wisp_mesh_generator* r, wisp_error* error )
{
    bool torus = r->shape == WISP_MESH_TORUS, delaunay = is_delaunay( r );
    float shallowest = fmaxf( SMALLEST_SIZE, r->width / MAX_SLENDER );
    float deepest = fminf( LARGEST_SIZE, r->width * MAX_SLENDER );
    const struct
    {
        const char* name;
        bool used;
        float value, least, most;
    } values[] = {
        { "spacing", is_plane( r ), r->spacing, SMALLEST_SIZE, LARGEST_SIZE },
        { "jitter", r->shape == WISP_MESH_PLANE_IRREGULAR, r->jitter, 0.0f, MAX_JITTER },
        { "radius", !is_plane( r ) && !delaunay, r->radius, SMALLEST_SIZE, LARGEST_SIZE },
        { "tube radius", torus, r->tube_radius, SMALLEST_SIZE, 0.999f * r->radius },
        { "length", has_length( r ), r->length, SMALLEST_SIZE, LARGEST_SIZE },
        { "lower radius", r->shape == WISP_MESH_TUBE && r->lower_radius != 0.0f, r->lower_radius, SMALLEST_SIZE,
          LARGEST_SIZE },
        { "width", delaunay, r->width, SMALLEST_SIZE, LARGEST_SIZE },
        { "depth", delaunay, r->depth, shallowest, deepest },
    };
    for ( int i = 0; i < WISP_COUNT( values ); ++i )
    {
        // Written so that NaN fails.
        if ( values[i].used && !( values[i].value >= values[i].least && values[i].value <= values[i].most ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "mesh generator: %s: got %g, expected %g .. %g", values[i].name,
                              (double)values[i].value, (double)values[i].least, (double)values[i].most );
        }
    }
    return WISP_OK;
}

// ---- planes ----------------------------------------------------------------------------------------------------

// Two triangles (a, c, d) and (a, d, b) become (a, c, b) and (b, c, d).
static void turn_diagonal( int32_t* t )
{
    const int32_t a = t[0], c = t[1], d = t[2], b = t[5];
    const int32_t other[] = { a, c, b, b, c, d };
    for ( int i = 0; i < 6; ++i )
    {
        t[i] = other[i];
    }
}

// All take a checked definition.
static wisp_status mesh_generate_plane( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    int columns = r->columns, rows = r->rows;
    WISP_TRY( mesh_allocate( out, columns * rows, 2 * ( columns - 1 ) * ( rows - 1 ), "mesh generator", error ) );
    wisp_status status =
        wisp_generate_grid( columns, rows, r->spacing, r->spacing, out->points, out->triangles, error );
    // every second diagonal the other way
    for ( int cell = 0; r->shape == WISP_MESH_PLANE_ALTERNATING && cell < ( columns - 1 ) * ( rows - 1 ); ++cell )
    {
        const int i = cell % ( columns - 1 ), j = cell / ( columns - 1 );
        if ( ( ( i + j ) & 1 ) != 0 )
        {
            turn_diagonal( out->triangles + 6 * cell );
        }
    }
    return status;
}

// ---- generation ------------------------------------------------------------------------------------------------

wisp_status wisp_mesh_generate( const wisp_mesh_generator* generator, wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    WISP_TRY( check_shape( generator, error ) );
    WISP_TRY( check_counts( generator, error ) );
    WISP_TRY( check_product( generator, error ) );
    WISP_TRY( check_sizes( generator, error ) );
    if ( generator->shape == WISP_MESH_PLANE_IRREGULAR )
    {
        return mesh_generate_irregular( generator, out, error );
    }
    if ( is_delaunay( generator ) )
    {
        return mesh_generate_delaunay( generator, out, error );
    }
    if ( is_plane( generator ) )
    {
        return mesh_generate_plane( generator, out, error );
    }
    return has_level( generator ) ? mesh_generate_icosphere( generator, out, error )
                                  : mesh_generate_turned( generator, out, error );
}
