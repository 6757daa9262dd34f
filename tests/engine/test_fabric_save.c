// Saved fabrics: a loaded fabric equals the saved one word for word, and no bytes load as a fabric that kernels could
// not trust.
#include "fabric_fixture.h"

#define HEAD_BYTES 24

typedef struct saved
{
    unsigned char* bytes;
    size_t size;
} saved;

static saved save( const wisp_fabric* fabric )
{
    saved s = { .size = wisp_fabric_saved_size( fabric ) };
    s.bytes = malloc( s.size );
    assert_int_equal( wisp_fabric_save( fabric, s.bytes, s.size, NULL ), WISP_OK );
    return s;
}

static wisp_fabric_def full_def( const test_mesh* mesh, const int32_t* attachments, int attachment_count )
{
    wisp_fabric_def def = test_fabric_def( mesh );
    def.attachments = attachments;
    def.attachment_count = attachment_count;
    def.hinges = def.tethers = true;
    def.coarse_sheets = true;
    return def;
}

// A fabric with something in every list, and more than one tile.
static wisp_fabric* cook_full( int width, int height )
{
    static const int32_t attachments[] = { 2, 7 };
    test_mesh mesh = test_mesh_plane( width, height );
    wisp_fabric_def def = full_def( &mesh, attachments, 2 );
    def.tile_size = 64;
    wisp_fabric* fabric = test_fabric_cook( &def );
    test_mesh_free( &mesh );
    return fabric;
}

// Sanitizers detect a read beyond the end only if the block ends there.
static wisp_status load_exact( const void* bytes, size_t size, wisp_fabric** out, wisp_error* error )
{
    unsigned char* block = malloc( size > 0 ? size : 1 );
    memcpy( block, bytes, size );
    wisp_status status = wisp_fabric_load( block, size, NULL, out, error );
    free( block );
    return status;
}

static void assert_refused( const void* bytes, size_t size, const char* part )
{
    wisp_error error = { 0 };
    wisp_fabric* fabric = (wisp_fabric*)&error;
    assert_int_equal( load_exact( bytes, size, &fabric, &error ), WISP_BAD_INPUT );
    assert_null( fabric );
    assert_one_message( error.message );
    assert_contains( error.message, part );
}

static void assert_level_is_equal( const wisp_fabric_level* a, const wisp_fabric_level* b )
{
    const size_t lanes = (size_t)a->schedule.slot_count * 4;
    const size_t parents = WISP_FABRIC_PARENTS * (size_t)a->finer_row_count * 4;
    assert_int_equal( a->vertex_count, b->vertex_count );
    assert_int_equal( a->row_count, b->row_count );
    assert_int_equal( a->link_count, b->link_count );
    assert_int_equal( a->finer_row_count, b->finer_row_count );
    assert_int_equal( a->schedule.slot_count, b->schedule.slot_count );
    assert_int_equal( a->chain_group_count, b->chain_group_count );
    assert_memory_equal( a->slot_x4, b->slot_x4, (size_t)a->row_count * 4 );
    assert_memory_equal( a->a_x4, b->a_x4, lanes );
    assert_memory_equal( a->b_x4, b->b_x4, lanes );
    assert_memory_equal( a->rest, b->rest, lanes );
    assert_memory_equal( a->fraction, b->fraction, lanes );
    assert_memory_equal( a->chain_rest, b->chain_rest, lanes );
    assert_memory_equal( a->chain_x4, b->chain_x4, (size_t)a->chain_begin[a->chain_group_count] * 32 );
    assert_memory_equal( a->parent_x4, b->parent_x4, parents );
    assert_memory_equal( a->weight, b->weight, parents );
}

static void a_loaded_fabric_is_the_saved_one( void** state )
{
    (void)state;
    test_mesh meshes[] = { test_mesh_plane( 24, 21 ), test_mesh_sphere( 9, 100 ), test_mesh_moebius( 20, 3 ),
                           test_mesh_book( 3 ),       test_mesh_make( 9, 0 ),     test_mesh_make( 0, 0 ) };
    for ( int i = 0; i < WISP_COUNT( meshes ); ++i )
    {
        static const int32_t attachments[] = { 2, 3 };
        wisp_fabric_def def = full_def( &meshes[i], attachments, meshes[i].vertex_count > 0 ? 2 : 0 );
        wisp_fabric* first = test_fabric_cook( &def );
        wisp_fabric* second = NULL;
        saved s = save( first );
        wisp_error error = { 0 };
        if ( load_exact( s.bytes, s.size, &second, &error ) != WISP_OK )
        {
            fail_msg( "mesh %d: %s", i, error.message );
        }
        assert_true( first->hash == second->hash );
        assert_fabric_holds( second, &def );
        assert_int_equal( first->tether_count, second->tether_count );
        assert_int_equal( first->level_count, second->level_count );
        for ( int k = 0; k < first->level_count; ++k )
        {
            assert_level_is_equal( &first->levels[k], &second->levels[k] );
        }
        saved again = save( second );
        assert_int_equal( again.size, s.size );
        assert_memory_equal( again.bytes, s.bytes, s.size );
        free( s.bytes );
        free( again.bytes );
        wisp_fabric_release( first );
        wisp_fabric_release( second );
        test_mesh_free( &meshes[i] );
    }
}

static void the_bytes_are_the_same_on_every_machine( void** state )
{
    (void)state;
    test_mesh mesh = test_mesh_make( 3, 1 );
    int next = 0;
    mesh.points[1].x = 1.0f;
    test_mesh_triangle( &mesh, &next, 0, 1, 2 );
    wisp_fabric_def def = test_fabric_def( &mesh );
    wisp_fabric* fabric = test_fabric_cook( &def );
    saved s = save( fabric );

    // magic, then the words of the content, little-endian; the content begins with three vertices and one triangle
    static const unsigned char begins[] = { 'W', 'I', 'S', 'P', 'F', 'A', 'B', '4' };
    static const unsigned char counts[] = { 3, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0 };
    assert_memory_equal( s.bytes, begins, sizeof( begins ) );
    assert_int_equal( s.bytes[8] | s.bytes[9] << 8, ( s.size - HEAD_BYTES ) / 4 );
    assert_memory_equal( s.bytes + HEAD_BYTES, counts, sizeof( counts ) );
    free( s.bytes );
    wisp_fabric_release( fabric );
    test_mesh_free( &mesh );
}

static void a_fabric_cut_at_any_byte_is_refused( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 3, 3 );
    saved s = save( fabric );
    for ( size_t size = 0; size < s.size; ++size )
    {
        assert_refused( s.bytes, size, "fabric" );
    }
    unsigned char* longer = calloc( s.size + 4, 1 );
    memcpy( longer, s.bytes, s.size );
    assert_refused( longer, s.size + 4, "expected" );
    free( longer );
    free( s.bytes );
    wisp_fabric_release( fabric );
}

static void any_flipped_bit_is_noticed( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 3, 3 );
    saved s = save( fabric );
    for ( size_t bit = 0; bit < 8 * s.size; ++bit )
    {
        s.bytes[bit / 8] ^= (unsigned char)( 1u << ( bit % 8 ) );
        assert_refused( s.bytes, s.size, "fabric" );
        s.bytes[bit / 8] ^= (unsigned char)( 1u << ( bit % 8 ) );
    }
    free( s.bytes );
    wisp_fabric_release( fabric );
}

static uint32_t word_at( const saved* s, size_t word )
{
    const unsigned char* p = s->bytes + HEAD_BYTES + 4 * word;
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void set_word( saved* s, size_t word, uint32_t value )
{
    for ( int i = 0; i < 4; ++i )
    {
        s->bytes[HEAD_BYTES + 4 * word + (size_t)i] = (unsigned char)( value >> ( 8 * i ) );
    }
}

// A forger can compute the hash.
static void forge_hash( saved* s )
{
    uint64_t hash = 0;
    for ( size_t word = 0; word < ( s->size - HEAD_BYTES ) / 4; ++word )
    {
        hash = ( hash ^ word_at( s, word ) ) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    for ( int i = 0; i < 8; ++i )
    {
        s->bytes[16 + i] = (unsigned char)( hash >> ( 8 * i ) );
    }
}

static void a_forged_word_is_refused_or_harms_nobody( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 9, 9 );
    saved s = save( fabric );
    size_t words = ( s.size - HEAD_BYTES ) / 4;
    int refused = 0, loaded = 0;
    for ( size_t word = 0; word < words; ++word )
    {
        uint32_t kept = word_at( &s, word );
        const uint32_t forged[] = {
            kept + 1, kept - 1, kept + 4, kept + 8, 0, 0x80000000u, 0x7fffffffu, 0xffffffffu
        };
        for ( int i = 0; i < WISP_COUNT( forged ); ++i )
        {
            wisp_fabric* result = NULL;
            wisp_error error = { 0 };
            set_word( &s, word, forged[i] );
            forge_hash( &s );
            if ( load_exact( s.bytes, s.size, &result, &error ) == WISP_OK )
            {
                assert_fabric_is_safe( result );
                loaded += forged[i] != kept ? 1 : 0;
                wisp_fabric_release( result );
            }
            else
            {
                assert_int_equal( error.status, WISP_BAD_INPUT );
                assert_one_message( error.message );
                refused += 1;
            }
        }
        set_word( &s, word, kept );
    }

    // the remaining loads have other lengths, areas and points: a different fabric but not a dangerous one
    assert_true( loaded > 0 && refused > 3 * loaded );
    free( s.bytes );
    wisp_fabric_release( fabric );
}

// Save a fabric with one replaced array, and check that it is rejected.
static void assert_forgery_is_refused( wisp_fabric forged, const char* part )
{
    forged.hash = fabric_hash( &forged );
    saved s = save( &forged );
    assert_refused( s.bytes, s.size, part );
    free( s.bytes );
}

static int32_t* copy_words( const void* words, int count )
{
    int32_t* copy = malloc( (size_t)count * 4 + 1 );
    memcpy( copy, words, (size_t)count * 4 );
    return copy;
}

static void neighbouring_tiles_in_one_colour_are_refused( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 20, 20 );
    int32_t all[] = { 0, fabric->link_order.tile_count };
    assert_true( fabric->link_order.colour_count > 1 );
    wisp_fabric forged = *fabric;
    forged.link_order.colour_count = 1;
    forged.link_order.colour_tile = all;
    assert_forgery_is_refused( forged, "at the same time" );
    wisp_fabric_release( fabric );
}

static void lanes_that_share_a_vertex_are_refused( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 20, 20 );
    int count = fabric->link_order.slot_count;
    int32_t *number = copy_words( fabric->link_order.constraint, count ),
            *a_x4 = copy_words( fabric->link_a_x4, count );
    int32_t *b_x4 = copy_words( fabric->link_b_x4, count ), *rest = copy_words( fabric->link_rest, count );

    // move a constraint of the same tile that shares a vertex with lane 0 into lane 1
    int32_t *columns[] = { number, a_x4, b_x4, rest }, other = 8;
    while ( a_x4[other] != a_x4[0] && b_x4[other] != a_x4[0] )
    {
        other += 1;
    }
    assert_true( other < fabric->link_order.tile_begin[1] );
    for ( int i = 0; i < 4; ++i )
    {
        int32_t kept = columns[i][1];
        columns[i][1] = columns[i][other];
        columns[i][other] = kept;
    }
    wisp_fabric forged = *fabric;
    forged.link_order.constraint = number;
    forged.link_a_x4 = a_x4;
    forged.link_b_x4 = b_x4;
    forged.link_rest = (const float*)(const void*)rest;
    assert_forgery_is_refused( forged, "at the same time" );
    for ( int i = 0; i < 4; ++i )
    {
        free( columns[i] );
    }
    wisp_fabric_release( fabric );
}

static void a_foreign_dummy_is_refused( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 20, 20 );
    int pad = 0;
    while ( pad < fabric->link_order.slot_count && fabric->link_order.constraint[pad] >= 0 )
    {
        pad += 1;
    }
    assert_true( pad < fabric->link_order.slot_count && fabric->tile_count > 1 );
    int32_t* a_x4 = copy_words( fabric->link_a_x4, fabric->link_order.slot_count );
    a_x4[pad] = 4 * ( fabric->vertex_count + ( a_x4[pad] / 4 == fabric->vertex_count ? 1 : 0 ) );
    wisp_fabric forged = *fabric;
    forged.link_a_x4 = a_x4;
    assert_forgery_is_refused( forged, "dummy" );
    free( a_x4 );
    wisp_fabric_release( fabric );
}

static void arrays_that_contradict_the_triangles_are_refused( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 20, 20 );
    int entries = fabric->ring_begin[fabric->ring_slice_count] * 8;
    int32_t* ring_x4 = copy_words( fabric->ring_x4, entries );
    ring_x4[entries / 2] += 4;
    wisp_fabric forged = *fabric;
    forged.ring_x4 = ( const int32_t( * )[8] )(void*)ring_x4;
    assert_forgery_is_refused( forged, "ring" );

    int32_t* slots = copy_words( fabric->vertex_slot, fabric->vertex_count );
    slots[3] = slots[4];
    forged = *fabric;
    forged.vertex_slot = slots;
    assert_forgery_is_refused( forged, "has another slot" );

    int32_t* triangles = copy_words( fabric->triangles, 3 * fabric->triangle_count );
    triangles[30] = fabric->vertex_count;
    forged = *fabric;
    forged.triangles = triangles;
    assert_forgery_is_refused( forged, "triangle 10" );
    free( ring_x4 );
    free( slots );
    free( triangles );
    wisp_fabric_release( fabric );
}

static void levels_that_would_divide_by_zero_or_move_wrongly_are_refused( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 30, 30 );
    assert_true( fabric->level_count == 1 );
    wisp_fabric_level level = fabric->levels[0];
    const int weights = WISP_FABRIC_PARENTS * level.finer_row_count;
    float* weight = (float*)(void*)copy_words( level.weight, weights );
    for ( int i = 0; i < weights; ++i )
    {
        weight[i] *= 0.5f;
    }
    wisp_fabric forged = *fabric;
    forged.levels = &level;
    level.weight = weight;
    assert_forgery_is_refused( forged, "weights that sum to 0.5" );
    level = fabric->levels[0];
    level.link_count = 0;
    assert_forgery_is_refused( forged, "0 links" );
    free( weight );
    wisp_fabric_release( fabric );
}

static void loading_without_memory_says_so_and_leaks_nothing( void** state )
{
    (void)state;
    wisp_fabric* fabric = cook_full( 9, 9 );
    saved s = save( fabric );
    bool refused = true;
    int64_t failures = 0;
    for ( int64_t n = 1; refused; ++n )
    {
        test_host host = { 0 };
        wisp_allocator allocator = test_host_allocator( &host );
        wisp_error error = { 0 };
        wisp_fabric* loaded = NULL;
        test_host_refuse( &host, n, false );
        wisp_status status = wisp_fabric_load( s.bytes, s.size, &allocator, &loaded, &error );
        refused = test_host_has_refused( &host );
        assert_int_equal( status, refused ? WISP_NO_MEMORY : WISP_OK );
        assert_int_equal( loaded == NULL, refused );
        failures += refused ? 1 : 0;
        wisp_fabric_release( loaded );
        assert_host_memory_is_released( &host );
    }
    assert_true( failures > 25 );
    free( s.bytes );
    wisp_fabric_release( fabric );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_loaded_fabric_is_the_saved_one ),
        cmocka_unit_test( the_bytes_are_the_same_on_every_machine ),
        cmocka_unit_test( a_fabric_cut_at_any_byte_is_refused ),
        cmocka_unit_test( any_flipped_bit_is_noticed ),
        cmocka_unit_test( a_forged_word_is_refused_or_harms_nobody ),
        cmocka_unit_test( neighbouring_tiles_in_one_colour_are_refused ),
        cmocka_unit_test( lanes_that_share_a_vertex_are_refused ),
        cmocka_unit_test( a_foreign_dummy_is_refused ),
        cmocka_unit_test( arrays_that_contradict_the_triangles_are_refused ),
        cmocka_unit_test( levels_that_would_divide_by_zero_or_move_wrongly_are_refused ),
        cmocka_unit_test( loading_without_memory_says_so_and_leaks_nothing ),
    };
    return cmocka_run_group_tests_name( "fabric save", tests, NULL, NULL );
}
