#include "boundary_oracle.h"

#include "oracle_check.h"

#include <stdlib.h>
#include <string.h>

static const double3 zero = { 0.0, 0.0, 0.0 };

// ---- creation and memory ----

wisp_status boundary_oracle_create( const balloon_mesh* mesh, const boundary_oracle_options* options,
                                    boundary_oracle_layer* out, wisp_error* error )
{
    boundary_oracle_layer made = { .options = *options,
                                   .vertex_count = mesh->vertex_count,
                                   .triangle_count = mesh->triangle_count };
    if ( !balloon_mesh_build_topology( mesh, &made.topology ) )
    {
        return refuse( error, WISP_NO_MEMORY, "out of memory for the edges of %d triangles", mesh->triangle_count );
    }
    made.edge_count = made.topology.edge_count;
    made.element_count = made.edge_count + made.triangle_count;
    const size_t elements = (size_t)made.element_count + 1;
    made.triangles = calloc( 3 * (size_t)mesh->triangle_count + 1, sizeof( int ) );
    made.vertex_normal = calloc( (size_t)mesh->vertex_count + 1, sizeof( double3 ) );
    made.element_normal = calloc( elements, sizeof( double3 ) );
    made.memory = calloc( elements, sizeof( boundary_oracle_memory ) );
    made.changed = calloc( elements, sizeof( bool ) );
    if ( made.triangles == NULL || made.vertex_normal == NULL || made.element_normal == NULL || made.memory == NULL ||
         made.changed == NULL )
    {
        boundary_oracle_destroy( &made );
        return refuse( error, WISP_NO_MEMORY, "out of memory for a layer on %d vertices", mesh->vertex_count );
    }
    memcpy( made.triangles, mesh->triangles, 3 * (size_t)mesh->triangle_count * sizeof( int ) );
    *out = made;
    return WISP_OK;
}

static void forget_element( boundary_oracle_memory* memory )
{
    free( memory->counts );
    free( memory->points );
    *memory = ( boundary_oracle_memory ){ 0 };
}

// Forget all counts: the next update samples every element again.
static void boundary_oracle_forget( boundary_oracle_layer* layer )
{
    for ( int e = 0; layer->memory != NULL && e < layer->element_count; ++e )
    {
        forget_element( layer->memory + e );
    }
}

void boundary_oracle_destroy( boundary_oracle_layer* layer )
{
    boundary_oracle_forget( layer );
    balloon_mesh_destroy_topology( &layer->topology );
    free( layer->triangles );
    free( layer->vertex_normal );
    free( layer->element_normal );
    free( layer->memory );
    free( layer->changed );
    free( layer->points );
    *layer = ( boundary_oracle_layer ){ 0 };
}

// ---- elements ----

// An element with the positions of its corners. An edge has two; its third is its first again.
typedef struct element
{
    int id;
    bool is_edge, is_finite;
    int vertex[3];
    double3 corner[3];
    double d;
    double length, area;       // of an edge; of a triangle
    boundary_oracle_axis axis; // of a triangle
} element;

static bool is_finite( double3 p )
{
    return isfinite( p.x ) && isfinite( p.y ) && isfinite( p.z );
}

static element element_of( const boundary_oracle_layer* layer, const double3* x, int id )
{
    const boundary_oracle_options* o = &layer->options;
    const int triangle = id - layer->edge_count;
    element found = { .id = id, .is_edge = triangle < 0, .d = o->spacing };
    if ( found.is_edge )
    {
        const balloon_mesh_edge* edge = layer->topology.edges + id;
        found.vertex[0] = found.vertex[2] = edge->a;
        found.vertex[1] = edge->b;
        found.d = o->edge_spacing != NULL ? o->edge_spacing[id] : o->spacing;
    }
    else
    {
        memcpy( found.vertex, layer->triangles + 3 * triangle, sizeof( found.vertex ) );
        found.d = o->triangle_spacing != NULL ? o->triangle_spacing[triangle] : o->spacing;
    }
    found.is_finite = true;
    for ( int k = 0; k < 3; ++k )
    {
        found.corner[k] = x[found.vertex[k]];
        found.is_finite = found.is_finite && is_finite( found.corner[k] );
    }
    found.length = double3_distance( found.corner[0], found.corner[1] );
    if ( !found.is_edge )
    {
        found.axis = boundary_oracle_axis_of( found.corner );
        found.area = 0.5 * found.axis.base * found.axis.height;
    }
    return found;
}

// The estimate sum( L / d ) + Area / d^2 over what can be sampled.
static double estimate( const boundary_oracle_layer* layer, const double3* x )
{
    double sum = 0.0;
    for ( int id = 0; id < layer->element_count; ++id )
    {
        const element e = element_of( layer, x, id );
        if ( e.is_finite )
        {
            sum += e.is_edge ? e.length / e.d : e.area / ( e.d * e.d );
        }
    }
    return sum;
}

// ---- counts ----

static bool has_room( boundary_oracle_memory* memory, int lines )
{
    memory->counts = calloc( (size_t)lines + 1, sizeof( int ) );
    memory->points = calloc( (size_t)lines + 1, sizeof( int ) );
    return memory->counts != NULL && memory->points != NULL;
}

static bool count_edge( const boundary_oracle_options* o, const element* e, const boundary_oracle_memory* before,
                        boundary_oracle_memory* now )
{
    now->line_count = 1;
    if ( !has_room( now, 1 ) )
    {
        return false;
    }
    const bool stays = o->hysteresis > 0.0 && before->sampled &&
                       boundary_oracle_may_stay( before->counts[0], e->length, e->d, o->rounding, o->hysteresis );
    now->counts[0] = stays ? before->counts[0] : boundary_oracle_count( e->length, e->d, o->rounding );
    now->points[0] = boundary_oracle_points( now->counts[0], e->length, e->d, o->policy );
    return true;
}

static double fraction_of_line( const boundary_oracle_options* o, const element* e, int k, int lines )
{
    return boundary_oracle_fraction( k, lines, e->axis.height, e->d, o->policy );
}

// Hysteresis. Lines only get shorter towards the top, so after the first line without points none has any. That line
// may become shorter, and with even spacing one part gives the same points as none.
static bool line_stays( const boundary_oracle_options* o, const element* e, int n, double length )
{
    const int parts = o->policy == BOUNDARY_ORACLE_EVEN && n < 1 ? 1 : n;
    const bool is_empty = boundary_oracle_points( n, length, e->d, o->policy ) == 0;
    return boundary_oracle_may_stay( parts, length, e->d, o->rounding, o->hysteresis ) ||
           ( is_empty && length < e->d );
}

static bool counts_stay( const boundary_oracle_options* o, const element* e, const boundary_oracle_memory* before )
{
    if ( !( o->hysteresis > 0.0 && before->sampled && before->axis == e->axis.edge ) )
    {
        return false;
    }
    bool stay = boundary_oracle_may_stay( before->line_count, e->axis.height, e->d, o->rounding, o->hysteresis );
    const int lines = boundary_oracle_points( before->line_count, e->axis.height, e->d, o->policy );
    for ( int k = 1, points = 1; k <= lines && stay && points > 0; ++k )
    {
        const double q = fraction_of_line( o, e, k, before->line_count );
        const double length = boundary_oracle_line_length( e->axis.base, q );
        stay = line_stays( o, e, before->counts[k - 1], length );
        points = boundary_oracle_points( before->counts[k - 1], length, e->d, o->policy );
    }
    return stay;
}

// Lines are placed along the height like points along an edge, and points along a line likewise.
static bool count_triangle( const boundary_oracle_options* o, const element* e, const boundary_oracle_memory* before,
                            boundary_oracle_memory* now )
{
    const bool stay = counts_stay( o, e, before );
    now->axis = e->axis.edge;
    now->line_count = stay ? before->line_count : boundary_oracle_count( e->axis.height, e->d, o->rounding );
    if ( !has_room( now, now->line_count ) )
    {
        return false;
    }
    const int lines = boundary_oracle_points( now->line_count, e->axis.height, e->d, o->policy );
    for ( int k = 1; k <= lines; ++k )
    {
        const double length =
            boundary_oracle_line_length( e->axis.base, fraction_of_line( o, e, k, now->line_count ) );
        now->counts[k - 1] = stay ? before->counts[k - 1] : boundary_oracle_count( length, e->d, o->rounding );
        now->points[k - 1] = boundary_oracle_points( now->counts[k - 1], length, e->d, o->policy );
    }
    return true;
}

static bool count( const boundary_oracle_layer* layer, const element* e, boundary_oracle_memory* now )
{
    const boundary_oracle_memory* before = layer->memory + e->id;
    *now = ( boundary_oracle_memory ){ .sampled = e->is_finite };
    if ( !e->is_finite )
    {
        return true;
    }
    return e->is_edge ? count_edge( &layer->options, e, before, now )
                      : count_triangle( &layer->options, e, before, now );
}

static int total( const boundary_oracle_memory* memory )
{
    int sum = 0;
    for ( int k = 0; k < memory->line_count; ++k )
    {
        sum += memory->points[k];
    }
    return sum;
}

// Case A. The drop rule at an end can remove a point without a change of counts, so points are compared as well as
// counts.
static bool is_same( const boundary_oracle_memory* a, const boundary_oracle_memory* b )
{
    const size_t bytes = (size_t)a->line_count * sizeof( int );
    return a->sampled == b->sampled && a->axis == b->axis && a->line_count == b->line_count &&
           ( bytes == 0 ||
             ( memcmp( a->counts, b->counts, bytes ) == 0 && memcmp( a->points, b->points, bytes ) == 0 ) );
}

// ---- points ----

// The weights of a point from its identity. Even ones follow from the counts alone, exact ones change with the
// lengths.
static void weigh( const boundary_oracle_options* o, const element* e, const boundary_oracle_memory* memory,
                   boundary_oracle_point* point )
{
    memcpy( point->parent, e->vertex, sizeof( point->parent ) );
    if ( e->is_edge )
    {
        const double tau = boundary_oracle_fraction( point->step, memory->counts[0], e->length, e->d, o->policy );
        point->weight[0] = 1.0 - tau;
        point->weight[1] = tau;
        point->weight[2] = 0.0;
        return;
    }
    const double q = fraction_of_line( o, e, point->line, memory->line_count );
    const double length = boundary_oracle_line_length( e->axis.base, q );
    const double r =
        boundary_oracle_fraction( point->step, memory->counts[point->line - 1], length, e->d, o->policy );
    boundary_oracle_weights( &e->axis, q, r, point->weight );
}

// The normal of a point from its weights, 0 where it cancels.
static double3 interpolate( const boundary_oracle_layer* layer, const element* e,
                            const boundary_oracle_memory* memory, const double weight[3] )
{
    const int* v = e->vertex;
    const double3 n[3] = { layer->vertex_normal[v[0]], layer->vertex_normal[v[1]], layer->vertex_normal[v[2]] };
    if ( e->is_edge )
    {
        return boundary_oracle_edge_normal( n[0], n[1], weight[1] );
    }
    const boundary_oracle_axis axis = boundary_oracle_axis_on( e->corner, memory->axis );
    const double r = weight[axis.b] / ( weight[axis.a] + weight[axis.b] );
    return boundary_oracle_inner_normal( n, &axis, weight[axis.c], r, layer->options.normals );
}

// Position and normal of a point from its weights. `point->normal` holds the previous normal.
static void follow( boundary_oracle_layer* layer, const element* e, const boundary_oracle_memory* memory,
                    boundary_oracle_point* point )
{
    point->y = zero;
    for ( int k = 0; k < 3; ++k )
    {
        point->y = double3_add( point->y, double3_scale( point->weight[k], e->corner[k] ) );
    }
    double3 normal = interpolate( layer, e, memory, point->weight );
    if ( double3_length( normal ) == 0.0 )
    {
        layer->fallback_normals += 1;
        normal = layer->element_normal[e->id];
        normal = double3_length( normal ) == 0.0 ? point->normal : normal;
    }
    point->normal = normal;
}

static boundary_oracle_point* sample( const element* e, const boundary_oracle_memory* memory,
                                      boundary_oracle_point* out )
{
    for ( int k = 0; k < memory->line_count; ++k )
    {
        for ( int j = 1; j <= memory->points[k]; ++j )
        {
            *out++ = ( boundary_oracle_point ){ .element = e->id, .line = e->is_edge ? 0 : k + 1, .step = j };
        }
    }
    return out;
}

// ---- one update ----

static void average_normals( boundary_oracle_layer* layer, const double3* x )
{
    boundary_oracle_vertex_normals( x, layer->vertex_count, layer->triangles, layer->triangle_count,
                                    layer->vertex_normal );
    memset( layer->element_normal, 0, (size_t)layer->element_count * sizeof( double3 ) );
    for ( int n = 0; n < 3 * layer->triangle_count; ++n )
    {
        const int* v = layer->triangles + n - n % 3;
        const double3 face = boundary_oracle_face_normal( ( const double3[3] ){ x[v[0]], x[v[1]], x[v[2]] } );
        double3* edge = layer->element_normal + layer->topology.triangle_edge[n];
        *edge = double3_add( *edge, face );
        layer->element_normal[layer->edge_count + n / 3] = face;
    }
    for ( int e = 0; e < layer->edge_count; ++e )
    {
        layer->element_normal[e] = boundary_oracle_unit( layer->element_normal[e] );
    }
}

static void count_or_keep( boundary_oracle_layer* layer, bool* complete, const element* e,
                           boundary_oracle_memory* now )
{
    if ( layer->refused )
    {
        *now = layer->memory[e->id];
    }
    else
    {
        *complete = count( layer, e, now ) && *complete;
    }
}

static void keep_points( boundary_oracle_layer* layer, const element* e, const boundary_oracle_memory* now,
                         const boundary_oracle_point** old, boundary_oracle_point** out )
{
    const int before = total( layer->memory + e->id ), after = total( now );
    layer->changed[e->id] = !is_same( layer->memory + e->id, now );
    if ( layer->changed[e->id] )
    {
        sample( e, now, *out );
    }
    else if ( after > 0 )
    {
        memcpy( *out, *old, (size_t)after * sizeof( boundary_oracle_point ) );
    }
    for ( int n = 0; n < after && e->is_finite; ++n )
    {
        if ( !layer->refused )
        {
            weigh( &layer->options, e, now, *out + n );
        }
        follow( layer, e, now, *out + n );
    }
    layer->changed_elements += layer->changed[e->id] ? 1 : 0;
    layer->skipped_elements += e->is_finite ? 0 : 1;
    layer->edge_point_count += e->is_edge ? after : 0;
    layer->point_count += after;
    *old += before;
    *out += after;
}

static void take_points( boundary_oracle_layer* layer, const double3* x, boundary_oracle_memory* now,
                         boundary_oracle_point* points )
{
    const boundary_oracle_point* old = layer->points;
    boundary_oracle_point* out = points;
    layer->point_count = layer->edge_point_count = 0;
    layer->changed_elements = layer->skipped_elements = layer->fallback_normals = 0;
    for ( int id = 0; id < layer->element_count; ++id )
    {
        const element e = element_of( layer, x, id );
        keep_points( layer, &e, now + id, &old, &out );
        if ( !layer->refused )
        {
            forget_element( layer->memory + id );
            layer->memory[id] = now[id];
        }
    }
    free( layer->points );
    layer->points = points;
}

bool boundary_oracle_update( boundary_oracle_layer* layer, const double3* x )
{
    average_normals( layer, x );
    layer->requested = estimate( layer, x );
    layer->refused = layer->requested > layer->options.cap;
    boundary_oracle_memory* now = calloc( (size_t)layer->element_count + 1, sizeof( boundary_oracle_memory ) );
    bool complete = now != NULL;
    size_t points = 1;
    for ( int id = 0; complete && id < layer->element_count; ++id )
    {
        const element e = element_of( layer, x, id );
        count_or_keep( layer, &complete, &e, now + id );
        points += complete ? (size_t)total( now + id ) : 0;
    }
    boundary_oracle_point* room = complete ? calloc( points, sizeof( boundary_oracle_point ) ) : NULL;
    if ( room != NULL )
    {
        take_points( layer, x, now, room );
    }
    for ( int id = 0; room == NULL && now != NULL && !layer->refused && id < layer->element_count; ++id )
    {
        forget_element( now + id );
    }
    free( now );
    return room != NULL;
}
