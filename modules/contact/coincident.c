// In: rows after a start or a jump. Out: positions, previous and intersection-free positions of points that lay on another
// participant. Two sheets in one plane have no normal between them, so their rows can push nothing, and the first rounding would
// lay each of their points on a side of its own.
#include "coincident.h"

#include <string.h>

static const float COINCIDENT = 1e-3f; // of the distance to keep: nearer counts as the same place
static const float PARTED = 0.1f;      // of it: what is nearer is pushed aside as much as apart

typedef struct parting_point
{
    float normal[3]; // sum over its triangles
    float way[3];    // sum of the directions that what it lies on faces
} parting_point;

// Participants that lie in one place form a group, in the order of their numbers. One that has pins stays.
typedef struct ply
{
    int32_t group; // the lowest number in it
    int32_t level; // participants below
    int32_t base;  // of a group: level of what stays
    float step;    // m, from level to level
    bool has_pins;
} ply;

typedef struct parting
{
    const contact_work* work;
    parting_point* points;
    ply* plies;
} parting;

static int number_of( const contact_contact_mesh* s, int point )
{
    return (int)s->rest[(size_t)point * 4 + 3];
}

static bool is_coincident( const contact_work* work, const contact_row* row )
{
    const contact_participant *a = contact_participant_of( work, row->point[0] ),
                              *b = contact_participant_of( work, row->point[row->split] );
    return a != b && a->is_strands == false && b->is_strands == false && row->distance < COINCIDENT * row->requested;
}

static void add_normals( const contact_contact_mesh* s, parting_point* points )
{
    for ( int t = 0; t < s->triangle_count; ++t )
    {
        const int32_t* corner = s->triangles + 3 * (size_t)t;
        const float *a = s->intersection_free + (size_t)corner[0] * 4,
                    *b = s->intersection_free + (size_t)corner[1] * 4,
                    *c = s->intersection_free + (size_t)corner[2] * 4;
        const float e[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] },
                    f[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
        for ( int k = 0; k < 3; ++k )
        {
            const int m = ( k + 1 ) % 3, n = ( k + 2 ) % 3;
            for ( int i = 0; i < 3; ++i )
            {
                points[corner[i]].normal[k] += e[m] * f[n] - e[n] * f[m];
            }
        }
    }
}

// All points of a row part along the normal of its earlier side.
static void add_ways( const parting* p, const contact_row* row )
{
    const contact_contact_mesh* s = p->work->contact_mesh;
    const bool is_first = number_of( s, row->point[0] ) < number_of( s, row->point[row->split] );
    float way[3] = { 0.0f };
    for ( int i = is_first ? 0 : row->split; i < ( is_first ? row->split : row->count ); ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            way[k] += fabsf( row->weight[i] ) * p->points[row->point[i]].normal[k];
        }
    }
    const float square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
    for ( int i = 0; i < row->count && square > 0.0f; ++i )
    {
        for ( int k = 0; k < 3 && fabsf( row->weight[i] ) > COINCIDENT; ++k )
        {
            p->points[row->point[i]].way[k] += way[k] / sqrtf( square );
        }
    }
}

// Join the groups of both sides and lay the later one on the earlier one. @return whether anything changed
static bool lay( const parting* p, const contact_row* row )
{
    const int a = number_of( p->work->contact_mesh, row->point[0] ),
              b = number_of( p->work->contact_mesh, row->point[row->split] );
    ply *below = p->plies + ( a < b ? a : b ), *above = p->plies + ( a < b ? b : a );
    const float step = contact_larger( contact_larger( below->step, above->step ), PARTED * row->requested );
    const int group = below->group < above->group ? below->group : above->group;
    const bool changes = below->group != group || above->group != group || above->level <= below->level ||
                         below->step < step || above->step < step;
    below->group = above->group = group;
    below->step = above->step = step;
    above->level = above->level > below->level ? above->level : below->level + 1;
    return changes;
}

// Find which participants have pins, and at which level the first of a group is.
static void find_bases( const parting* p )
{
    const contact_contact_mesh* s = p->work->contact_mesh;
    for ( int i = 0; i < s->point_count; ++i )
    {
        ply* own = p->plies + number_of( s, i );
        own->has_pins = own->has_pins || s->now[(size_t)i * 4 + 3] == 0.0f;
    }
    for ( int g = p->work->participant_count - 1; g >= 0; --g )
    {
        if ( p->plies[g].has_pins )
        {
            p->plies[p->plies[g].group].base = p->plies[g].level;
        }
    }
}

static void move_points( const parting* p, int number )
{
    contact_contact_mesh* s = p->work->contact_mesh;
    const contact_participant* participant = p->work->participants + number;
    const ply* own = p->plies + number;
    const float length = own->step * (float)( own->level - p->plies[own->group].base );
    float* position = wisp_frame_column( p->work->frame, participant->entity, WISP_PARTICLE_POSITION, 0 );
    float* previous = wisp_frame_column( p->work->frame, participant->entity, WISP_PARTICLE_PREVIOUS, 0 );
    for ( int i = 0; i < participant->point_count; ++i )
    {
        const size_t at = (size_t)( participant->first_point + i ) * 4;
        const float* way = p->points[participant->first_point + i].way;
        const float sum = sqrtf( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] );
        for ( size_t k = 0; k < 3 && sum > 0.5f && s->now[at + 3] > 0.0f; ++k )
        {
            const float step = length * way[k] / sum;
            s->now[at + k] += step;
            s->intersection_free[at + k] += step;
            position[(size_t)i * 4 + k] += step;
            previous[(size_t)i * 4 + k] += step;
        }
    }
}

// @return false without memory
static bool begin_parting( parting* p )
{
    const contact_contact_mesh* s = p->work->contact_mesh;
    const size_t points = (size_t)s->point_count * sizeof( *p->points ),
                 plies = (size_t)p->work->participant_count * sizeof( *p->plies );
    p->points = wisp_parallel_scratch( p->work->parallel, p->work->worker, points );
    p->plies = wisp_parallel_scratch( p->work->parallel, p->work->worker, plies );
    if ( p->points == NULL || p->plies == NULL )
    {
        return false;
    }
    memset( p->points, 0, points );
    memset( p->plies, 0, plies );
    for ( int g = 0; g < p->work->participant_count; ++g )
    {
        p->plies[g].group = g;
    }
    add_normals( s, p->points );
    return true;
}

void contact_part_coincident( const contact_work* work )
{
    const contact_constraints* constraints = work->contact_mesh->constraints;
    parting p = { .work = work };
    bool any = false, changes = true;
    for ( int r = 0; r < constraints->row_count; ++r )
    {
        const contact_row* row = constraints->rows + r;
        if ( is_coincident( work, row ) )
        {
            if ( any == false && begin_parting( &p ) == false )
            {
                return; // without memory they stay in one place
            }
            any = true;
            add_ways( &p, row );
        }
    }
    for ( int sweep = 0; sweep < work->participant_count && any && changes; ++sweep )
    {
        changes = false;
        for ( int r = 0; r < constraints->row_count; ++r )
        {
            const contact_row* row = constraints->rows + r;
            changes = ( is_coincident( work, row ) && lay( &p, row ) ) || changes;
        }
    }
    if ( any )
    {
        find_bases( &p );
    }
    for ( int g = 0; g < work->participant_count && any; ++g )
    {
        if ( work->participants[g].is_strands == false && work->participants[g].halted == false )
        {
            move_points( &p, g );
        }
    }
}
