// Projection of contact constraints (position based dynamics, Mueller et al. 2007), accumulated and clamped as the
// impulses of Catto 2005. In: rows by colour. Out: moved points, accumulated corrections.
//
// - Push: Dx_i = w_i s_i n l with l = -C / max( sum w_j s_j^2, max w_j |s_j| / 4 ), accumulated in
//   `normal_impulse`, which is never negative. The weights of a row sum to zero, so every correction keeps
//   momentum, and forces on two participants are equal and opposite.
// - Friction takes back the relative tangential displacement of the closest points since the start of the substep,
//   accumulated in `tangential_impulse`, which is never longer than mu times the push (Coulomb).
// - A substep begins with the impulses of the one before (warm start). One sweep goes one layer down a pile; with what is
//   remembered, its weight is with the ground after as many substeps, and it comes to rest. Without, each layer sinks
//   into the one below and is thrown out again.
// - Half spaces of bodies have their turn after each sweep, with friction (kernel half_space): bodies win.
// - Recovery parts pairs that are nearer than their gap at `max_push_out_speed`. The previous positions move too: no
//   velocity.
#include "solve.h"

#include "constraints.h"

#include "wisp/module/kernels.h"
#include <string.h>

enum
{
    MAX_LEVER = 4, // a correction moves no point by more than this many times what the sides lack
    ROW_SWEEPS = 2,
    BODY_GRAIN = 256,
    WARM_GRAIN = 256,
};

// Pairs nearer than this fraction of the gap recover. If all did, those of a pile would part each other for ever.
static const float RECOVERED = 0.95f;

typedef void row_fn( const contact_work* work, contact_row* row );

typedef struct project_loop
{
    const contact_work* work;
    const int32_t* order;
    row_fn* run;
} project_loop;

// Return the mobility of a row, sum w s^2, in 1/kg, but at least max w |s| / MAX_LEVER. Where the only free point of a
// triangle is far from the contact, s is small, and a correction over sum w s^2 would throw it.
static float mobility_of( const contact_contact_mesh* s, const contact_row* row )
{
    float sum = 0.0f, farthest = 0.0f;
    for ( int i = 0; i < row->count; ++i )
    {
        const float way = s->now[(size_t)row->point[i] * 4 + 3] * row->weight[i];
        sum += way * row->weight[i];
        farthest = contact_larger( farthest, fabsf( way ) );
    }
    return contact_larger( sum, farthest / MAX_LEVER );
}

// Return the distance of the two sides along the normal. Sums are relative to one of the points, against
// cancellation.
static float distance_of( const float* xyzw, const contact_row* row )
{
    const float* o = xyzw + (size_t)row->point[row->count - 1] * 4;
    float d[3] = { 0.0f, 0.0f, 0.0f };
    for ( int i = 0; i + 1 < row->count; ++i )
    {
        const float* p = xyzw + (size_t)row->point[i] * 4;
        for ( int k = 0; k < 3; ++k )
        {
            d[k] += row->weight[i] * ( p[k] - o[k] );
        }
    }
    return row->normal[0] * d[0] + row->normal[1] * d[1] + row->normal[2] * d[2];
}

static void move( float* xyzw, const float* masses, const contact_row* row, const float by[3] )
{
    for ( int i = 0; i < row->count; ++i )
    {
        const size_t at = (size_t)row->point[i] * 4;
        const float fraction = masses[at + 3] * row->weight[i];
        xyzw[at] += fraction * by[0];
        xyzw[at + 1] += fraction * by[1];
        xyzw[at + 2] += fraction * by[2];
    }
}

static float inner( const float a[3], const float b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Find how far the first side moved relative to the second, along the plane.
static void find_slip( const contact_contact_mesh* s, const contact_row* row, float slip[3] )
{
    float along = 0.0f;
    memset( slip, 0, 3 * sizeof( float ) );
    for ( int i = 0; i < row->count; ++i )
    {
        const float *p = s->now + (size_t)row->point[i] * 4, *q = s->intersection_free + (size_t)row->point[i] * 4;
        for ( int k = 0; k < 3; ++k )
        {
            slip[k] += row->weight[i] * ( p[k] - q[k] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        along += row->normal[k] * slip[k];
    }
    for ( int k = 0; k < 3; ++k )
    {
        slip[k] -= along * row->normal[k];
    }
}

// The half space that presses most on each point of a row, as a row of the kernel half_space; null: none.
typedef struct row_holds
{
    float* half[CONTACT_MAX_POINTS];
} row_holds;

// Return how far a point is from the border of a half space, m; negative: it has left it.
static float distance_in( const float* half, const float p[3] )
{
    const float from[3] = { p[0] - half[0], p[1] - half[1], p[2] - half[2] };
    return inner( half + 3, from ) - half[9];
}

static float* half_space_of( const contact_work* work, int point )
{
    const contact_participant* participant = contact_participant_of( work, point );
    const bool is_free = work->contact_mesh->now[(size_t)point * 4 + 3] > 0.0f;
    const int i = point - participant->first_point,
              found = participant->half_spaces != NULL && is_free ? participant->half_spaces[i] : 0;
    float *most = NULL, pressed = 0.0f;
    for ( int k = 0; k < found && k < WISP_MAX_HALF_SPACES; ++k )
    {
        float* half = participant->half_space_row + 16 * ( (size_t)i * WISP_MAX_HALF_SPACES + (size_t)k );
        most = half[10] > pressed ? half : most;
        pressed = contact_larger( pressed, half[10] );
    }
    return most;
}

static row_holds find_holds( const contact_work* work, const contact_row* row )
{
    row_holds holds;
    for ( int i = 0; i < row->count; ++i )
    {
        holds.half[i] = half_space_of( work, row->point[i] );
    }
    return holds;
}

// Return the mobility of a row in a direction: what is held does not move along the normal of what holds it.
static float mobility_along( const contact_contact_mesh* s, const contact_row* row, const row_holds* holds,
                             const float direction[3] )
{
    float sum = 0.0f, farthest = 0.0f;
    for ( int i = 0; i < row->count; ++i )
    {
        const float fraction = s->now[(size_t)row->point[i] * 4 + 3] * row->weight[i];
        const float against = holds->half[i] != NULL ? inner( holds->half[i] + 3, direction ) : 0.0f;
        const float free = contact_larger( 1.0f - against * against, 0.0f );
        sum += fraction * row->weight[i] * free;
        farthest = contact_larger( farthest, fabsf( fraction ) * sqrtf( free ) );
    }
    return contact_larger( sum, farthest / MAX_LEVER );
}

// Add an impulse to a row. What pushes a point against the half space that holds it goes to its correction instead.
static void push( contact_contact_mesh* s, const contact_row* row, const row_holds* holds, const float impulse[3] )
{
    for ( int i = 0; i < row->count; ++i )
    {
        const size_t at = (size_t)row->point[i] * 4;
        const float fraction = s->now[at + 3] * row->weight[i];
        float by[3] = { fraction * impulse[0], fraction * impulse[1], fraction * impulse[2] };
        float* half = holds->half[i];
        if ( half != NULL )
        {
            const float before = half[10];
            half[10] = contact_larger( before - inner( half + 3, by ), 0.0f );
            for ( int k = 0; k < 3; ++k )
            {
                by[k] -= ( before - half[10] ) * half[3 + k];
            }
        }
        s->now[at] += by[0];
        s->now[at + 1] += by[1];
        s->now[at + 2] += by[2];
    }
}

// Take back slip, up to the friction of the row.
static void apply_friction( contact_contact_mesh* s, contact_row* row, const row_holds* holds )
{
    const float most = row->friction * row->normal_impulse;
    float slip[3], direction[3], by[3];
    find_slip( s, row, slip );
    const float length = sqrtf( inner( slip, slip ) );
    for ( int k = 0; k < 3; ++k )
    {
        direction[k] = length > 0.0f ? slip[k] / length : 0.0f;
    }
    const float mobility = mobility_along( s, row, holds, direction );
    for ( int k = 0; k < 3; ++k )
    {
        by[k] = row->tangential_impulse[k] - ( mobility > 0.0f ? slip[k] / mobility : 0.0f );
    }
    const float squared = inner( by, by ), scale = squared > most * most ? most / sqrtf( squared ) : 1.0f;
    for ( int k = 0; k < 3; ++k )
    {
        by[k] = scale * by[k] - row->tangential_impulse[k];
        row->tangential_impulse[k] += by[k];
    }
    push( s, row, holds, by );
}

static void project_row( const contact_work* work, contact_row* row )
{
    contact_contact_mesh* s = work->contact_mesh;
    const float short_by = row->gap - distance_of( s->now, row );
    if ( !( short_by > 0.0f || row->normal_impulse > 0.0f ) )
    {
        return;
    }
    row_holds holds = find_holds( work, row );
    float mobility = mobility_along( s, row, &holds, row->normal );
    if ( !( mobility > 0.0f ) ) // nothing but what bodies hold can move
    {
        holds = ( row_holds ){ { NULL } };
        mobility = mobility_of( s, row );
    }
    if ( !( mobility > 0.0f ) )
    {
        return;
    }
    const float impulse = contact_larger( 0.0f, row->normal_impulse + short_by / mobility ),
                change = impulse - row->normal_impulse;
    const float by[3] = { change * row->normal[0], change * row->normal[1], change * row->normal[2] };
    row->normal_impulse = impulse;
    push( s, row, &holds, by );
    if ( row->friction > 0.0f )
    {
        apply_friction( s, row, &holds );
    }
}

static void recover_row( const contact_work* work, contact_row* row )
{
    contact_contact_mesh* s = work->contact_mesh;
    const contact_participant* participant = work->participants + (int)s->rest[(size_t)row->point[0] * 4 + 3];
    const float step = participant->settings.max_push_out_speed * work->seconds;
    const float short_by = contact_smaller( row->requested, row->distance + step ) - distance_of( s->now, row );
    const bool is_near = row->distance < RECOVERED * row->requested;
    const float sum = is_near && short_by > 0.0f ? mobility_of( s, row ) : 0.0f;
    if ( sum > 0.0f )
    {
        const float length = contact_smaller( short_by, step ) / sum;
        const float by[3] = { length * row->normal[0], length * row->normal[1], length * row->normal[2] };
        move( s->now, s->now, row, by );
        move( s->shift, s->now, row, by );
    }
}

static void run_blocks( void* context, int begin, int end, int worker )
{
    (void)worker;
    const project_loop* loop = context;
    const contact_contact_mesh* s = loop->work->contact_mesh;
    for ( int i = begin; i < end; ++i )
    {
        const int block = loop->order[i];
        for ( int r = s->colouring->begin[block]; r < s->colouring->begin[block + 1]; ++r )
        {
            loop->run( loop->work, s->constraints->rows + r );
        }
    }
}

static void run_all( const contact_work* work, row_fn* run )
{
    const contact_colouring* blocks = work->contact_mesh->colouring;
    for ( int colour = 0; colour < CONTACT_COLOURS; ++colour )
    {
        const int first = blocks->colour[colour], count = blocks->colour[colour + 1] - first;
        project_loop loop = { work, blocks->order + first, run };
        const int grain = colour + 1 < CONTACT_COLOURS ? 1 : count; // the last colour runs serially
        if ( count > 0 )
        {
            wisp_parallel_for( work->parallel, count, grain, run_blocks, &loop );
        }
    }
}

// ---- bodies ----

typedef struct bodies_loop
{
    const contact_work* work;
    const contact_participant* participant;
} bodies_loop;

// Another sweep over the half spaces of points: what rows pushed into bodies comes out, with friction.
static void press_on_bodies( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bodies_loop* loop = context;
    const contact_participant* participant = loop->participant;
    contact_contact_mesh* s = loop->work->contact_mesh;
    const size_t first = (size_t)participant->first_point * 4;
    int32_t particle_x4[BODY_GRAIN + WISP_SLICE], row_x16[BODY_GRAIN + WISP_SLICE];
    const wisp_half_space_args args = { s->now + first, s->intersection_free + first, participant->half_space_row,
                                        particle_x4, row_x16 };
    for ( int k = 0; k < WISP_MAX_HALF_SPACES; ++k )
    {
        int count = 0;
        for ( int i = begin; i < end; ++i )
        {
            particle_x4[count] = 4 * i;
            row_x16[count] = 16 * ( WISP_MAX_HALF_SPACES * i + k );
            count += participant->half_spaces[i] > k && s->now[first + 4 * (size_t)i + 3] > 0.0f ? 1 : 0;
        }
        for ( int i = count; count > 0 && i % WISP_SLICE != 0; ++i )
        {
            particle_x4[i] = particle_x4[count - 1];
            row_x16[i] = row_x16[count - 1];
        }
        wisp_frame_kernels( loop->work->frame )->half_space( &args, 0, count );
    }
}

static void project_bodies( const contact_work* work )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        bodies_loop loop = { work, work->participants + g };
        if ( loop.participant->half_spaces != NULL && loop.participant->half_space_row != NULL )
        {
            wisp_parallel_for( work->parallel, loop.participant->point_count, BODY_GRAIN, press_on_bodies, &loop );
        }
    }
}

void contact_project_rows( const contact_work* work )
{
    for ( int sweep = 0; sweep < ROW_SWEEPS; ++sweep )
    {
        run_all( work, project_row );
        project_bodies( work );
    }
}

// ---- impulses that outlive the substep ----

// Describe a row by numbers that do not change with the contact mesh.
static contact_impulse name_of( const contact_work* work, int number )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_row* row = s->constraints->rows + number;
    const contact_participant *a = contact_participant_of( work, row->point[0] ),
                              *b = contact_participant_of( work, row->point[row->split] );
    const bool are_edges = number >= s->constraints->split;
    return ( contact_impulse ){
        .a = row->a - ( are_edges ? a->first_edge : a->first_point ),
        .b = are_edges ? ~( row->b - b->first_edge ) : row->b - b->first_triangle,
        .of = (uint32_t)( a - work->participants ) + ( (uint32_t)( b - work->participants ) << 16 ),
    };
}

// Return the impulses that a point keeps, null for those of strands.
static contact_load* load_of( const contact_work* work, int point )
{
    const contact_participant* participant = contact_participant_of( work, point );
    return participant->loads != NULL ? participant->loads + ( point - participant->first_point ) : NULL;
}

// Return the impulse of a pair that its points keep, or else the first free place for one, or null.
static contact_impulse* find_impulse( const contact_work* work, const contact_row* row, const contact_impulse* name,
                                      bool is_free )
{
    for ( int i = 0; i < row->count; ++i )
    {
        contact_load* load = load_of( work, row->point[i] );
        for ( int k = 0; k < CONTACT_KEPT && load != NULL; ++k )
        {
            contact_impulse* kept = load->pairs + k;
            if ( !( kept->normal > 0.0f ) )
            {
                if ( is_free )
                {
                    return kept;
                }
                break;
            }
            if ( is_free == false && kept->a == name->a && kept->b == name->b && kept->of == name->of )
            {
                return kept;
            }
        }
    }
    return NULL;
}

static void warm_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    for ( int r = begin; r < end; ++r )
    {
        contact_row* row = work->contact_mesh->constraints->rows + r;
        const contact_impulse name = name_of( work, r ), *kept = find_impulse( work, row, &name, false );
        if ( kept != NULL )
        {
            row->normal_impulse = kept->normal;
            memcpy( row->tangential_impulse, kept->along, sizeof( kept->along ) );
        }
    }
}

static void push_warm( const contact_work* work, contact_row* row )
{
    float by[3];
    for ( int k = 0; k < 3; ++k )
    {
        by[k] = row->normal_impulse * row->normal[k] + row->tangential_impulse[k];
    }
    if ( row->normal_impulse > 0.0f )
    {
        const row_holds holds = find_holds( work, row );
        push( work->contact_mesh, row, &holds, by );
    }
}

void contact_start_warm( const contact_work* work )
{
    wisp_parallel_for( work->parallel, work->contact_mesh->constraints->row_count, WARM_GRAIN, warm_rows,
                       (void*)(uintptr_t)work );
    run_all( work, push_warm );
    project_bodies( work );
}

void contact_keep_impulses( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        if ( participant->loads != NULL && participant->is_left_out == false )
        {
            memset( participant->loads, 0, (size_t)participant->point_count * sizeof( contact_load ) );
        }
    }
    for ( int r = 0; r < s->constraints->row_count; ++r )
    {
        const contact_row* row = s->constraints->rows + r;
        contact_impulse name = name_of( work, r );
        contact_impulse* to = row->normal_impulse > 0.0f ? find_impulse( work, row, &name, true ) : NULL;
        if ( to != NULL )
        {
            *to = name;
            to->normal = row->normal_impulse;
            memcpy( to->along, row->tangential_impulse, sizeof( to->along ) );
        }
    }
}

// Recovery pushes nothing into bodies, and gives no velocity.
static void leave_bodies( const contact_work* work, const contact_participant* participant )
{
    contact_contact_mesh* s = work->contact_mesh;
    for ( int i = 0; i < participant->point_count; ++i )
    {
        const size_t at = (size_t)( participant->first_point + i ) * 4;
        const int found = s->now[at + 3] > 0.0f ? participant->half_spaces[i] : 0;
        for ( int k = 0; k < found && k < WISP_MAX_HALF_SPACES; ++k )
        {
            const float *half = participant->half_space_row + 16 * ( (size_t)i * WISP_MAX_HALF_SPACES + (size_t)k ),
                        *p = s->now + at;
            const float depth = -distance_in( half, p );
            for ( size_t c = 0; c < 3 && depth > 0.0f; ++c )
            {
                s->now[at + c] += depth * half[3 + c];
                s->shift[at + c] += depth * half[3 + c];
            }
        }
    }
}

void contact_recover( const contact_work* work )
{
    run_all( work, recover_row );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        if ( work->participants[g].half_spaces != NULL )
        {
            leave_bodies( work, work->participants + g );
        }
    }
}

// Colouring: constraints in blocks of 64 that one worker projects from first to last, coloured greedily so that
// blocks of one colour share no point. In: rows. Out: blocks in the order of their colours. Blocks do not depend on
// the number of workers.

enum
{
    ROWS_PER_BLOCK = 64,
};

static void cut_blocks( contact_colouring* blocks, int split, int count )
{
    blocks->count = 0;
    for ( int begin = 0; begin < count; )
    {
        const int most = begin < split ? split : count;
        blocks->begin[blocks->count++] = begin;
        begin = begin + ROWS_PER_BLOCK < most ? begin + ROWS_PER_BLOCK : most;
    }
    blocks->begin[blocks->count] = count;
}

// Take the lowest colour that no point of the block has yet. Blocks without one get the last colour, which runs
// serially.
static int colour_block( contact_contact_mesh* s, int begin, int end )
{
    uint64_t taken = 0;
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < s->constraints->rows[r].count; ++i )
        {
            taken |= s->colouring->of_point[s->constraints->rows[r].point[i]];
        }
    }
    int colour = 0;
    while ( colour < CONTACT_COLOURS - 1 && ( taken >> colour & 1 ) != 0 )
    {
        colour += 1;
    }
    for ( int r = begin; r < end; ++r )
    {
        for ( int i = 0; i < s->constraints->rows[r].count; ++i )
        {
            s->colouring->of_point[s->constraints->rows[r].point[i]] |= UINT64_C( 1 ) << colour;
        }
    }
    return colour;
}

static void colour_blocks( contact_contact_mesh* s )
{
    contact_colouring* blocks = s->colouring;
    memset( blocks->colour, 0, sizeof( blocks->colour ) );
    memset( blocks->of_point, 0, (size_t)s->point_count * sizeof( *blocks->of_point ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        blocks->colour_of[b] = colour_block( s, blocks->begin[b], blocks->begin[b + 1] );
        blocks->colour[blocks->colour_of[b] + 1] += 1;
    }
    for ( int i = 0; i < CONTACT_COLOURS; ++i )
    {
        blocks->colour[i + 1] += blocks->colour[i];
    }
    int next[CONTACT_COLOURS];
    memcpy( next, blocks->colour, sizeof( next ) );
    for ( int b = 0; b < blocks->count; ++b )
    {
        blocks->order[next[blocks->colour_of[b]]++] = b;
    }
}

bool contact_reserve_colouring( const contact_work* work )
{
    contact_colouring* c = work->contact_mesh->colouring;
    return contact_reserve( work, &c->point_buffer, (size_t)work->contact_mesh->point_count * sizeof( *c->of_point ),
                            (void**)&c->of_point );
}

wisp_status contact_colour_rows( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_colouring* c = s->colouring;
    c->count = 0;
    const size_t most = (size_t)( s->constraints->row_count / ROWS_PER_BLOCK + 2 ), index = sizeof( int32_t );
    wisp_buffer* b = c->buffers;
    if ( contact_reserve( work, b++, ( most + 1 ) * index, (void**)&c->begin ) == false ||
         contact_reserve( work, b++, most * index, (void**)&c->colour_of ) == false ||
         contact_reserve( work, b++, most * index, (void**)&c->order ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for blocks of %d pairs", s->constraints->row_count );
    }
    cut_blocks( c, s->constraints->split, s->constraints->row_count );
    colour_blocks( s );
    return WISP_OK;
}
