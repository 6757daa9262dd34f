// Projection of contact constraints (position based dynamics, Mueller et al. 2007), accumulated and clamped as the
// impulses of Catto 2005. In: rows by colour. Out: moved points, accumulated corrections.
//
// - Push: Dx_i = w_i s_i n l with l = -C / max( sum w_j s_j^2, max w_j |s_j| / 4 ), accumulated in
//   `normal_correction`, which is never negative. The weights of a row sum to zero, so every correction keeps
//   momentum, and forces on two participants are equal and opposite.
// - Friction takes back the relative tangential displacement of the closest points since the start of the substep,
//   accumulated in `tangential_correction`, which is never longer than mu times the push (Coulomb).
// - What a body supports is not pushed into it, and lower layers not by higher ones: supports.c.
// - Recovery parts pairs that are nearer than their gap at `max_push_out_speed`. The previous positions move too: no
//   velocity.
#include "solve.h"

#include "constraints.h"
#include "supports.h"

#include <string.h>

typedef void row_fn( const contact_work* work, contact_row* row );

typedef struct project_loop
{
    const contact_work* work;
    const int32_t* order;
    row_fn* run;
} project_loop;

static float mobility_of( const contact_contact_mesh* s, const contact_row* row )
{
    return contact_mobility_of( s, row, ( contact_side ){ 0, row->count } );
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

static void apply_friction( contact_contact_mesh* s, contact_row* row, float inverse )
{
    float way[3] = { 0.0f, 0.0f, 0.0f }, by[3];
    contact_add_way( s, row, 0, row->count, way );
    contact_find_slip( row, way, row->friction * row->normal_correction, by );
    for ( int k = 0; k < 3; ++k )
    {
        by[k] = inverse * by[k];
    }
    move( s->now, s->now, row, by );
}

static void project_row( const contact_work* work, contact_row* row )
{
    contact_contact_mesh* s = work->contact_mesh;
    const float short_by = row->gap - distance_of( s->now, row );
    const float sum = short_by > -row->normal_correction ? mobility_of( s, row ) : 0.0f;
    if ( !( sum > 0.0f ) )
    {
        return;
    }
    const float correction = contact_larger( 0.0f, row->normal_correction + short_by );
    const float change = correction - row->normal_correction, length = change / sum;
    const float by[3] = { length * row->normal[0], length * row->normal[1], length * row->normal[2] };
    row->normal_correction = correction;
    if ( contact_is_supported( work, row ) )
    {
        contact_move_supported( work, row, change, sum );
        if ( row->friction > 0.0f && correction > 0.0f )
        {
            contact_apply_pile_friction( work, row );
        }
        contact_keep_inside( work, row );
        return;
    }
    move( s->now, s->now, row, by );
    if ( row->friction > 0.0f && correction > 0.0f )
    {
        apply_friction( s, row, 1.0f / sum );
    }
}

static void recover_row( const contact_work* work, contact_row* row )
{
    contact_contact_mesh* s = work->contact_mesh;
    const contact_participant* participant = work->participants + (int)s->rest[(size_t)row->point[0] * 4 + 3];
    const float step = participant->settings.max_push_out_speed * work->seconds;
    const float short_by = contact_smaller( row->requested, row->distance + step ) - distance_of( s->now, row );
    const float sum = short_by > 0.0f ? mobility_of( s, row ) : 0.0f;
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

// Rows that were projected later have moved points of those before them, so piles need their friction once more.
static void hold_row( const contact_work* work, contact_row* row )
{
    if ( row->friction > 0.0f && row->normal_correction > 0.0f && row->mobility > 0.0f )
    {
        contact_apply_pile_friction( work, row );
        contact_keep_inside( work, row );
    }
}

void contact_project_rows( const contact_work* work )
{
    run_all( work, project_row );
    if ( work->contact_mesh->supports->any )
    {
        run_all( work, hold_row );
    }
}

void contact_recover( const contact_work* work )
{
    run_all( work, recover_row );
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
