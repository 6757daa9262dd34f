// Vertices that a file splits where normals or texture coordinates differ become one again: cloth must not fall apart
// at its seams. Only exactly equal positions with exactly equal joints, weights and displacements are the same vertex.
#include "gltf_internal.h"

#include <stdlib.h>
#include <string.h>

#include "io_file.h"

enum
{
    WORDS = 11, // of a vertex: position, joints, weights
};

static void key_of( const gltf_mesh* mesh, int v, uint32_t key[WORDS] )
{
    memset( key, 0, WORDS * sizeof *key );
    // A negative zero is the same place.
    const float p[3] = { mesh->mesh.points[v].x + 0.0f, mesh->mesh.points[v].y + 0.0f,
                         mesh->mesh.points[v].z + 0.0f };
    memcpy( key, p, sizeof p );
    if ( mesh->joints != NULL )
    {
        memcpy( key + 3, mesh->joints + 4 * (size_t)v, 4 * sizeof *mesh->joints );
        memcpy( key + 7, mesh->weights + 4 * (size_t)v, 4 * sizeof *mesh->weights );
    }
}

// Of a morph target, whose rows keep their length while vertices are merged.
static float* displacement( const gltf_mesh* mesh, int target, int v )
{
    return mesh->targets + 3 * ( (size_t)target * (size_t)mesh->mesh.vertex_count + (size_t)v );
}

// Vertices that only start at one place stay apart.
static bool moves_alike( const gltf_mesh* mesh, int a, int b )
{
    bool alike = true;
    for ( int t = 0; t < mesh->target_count && alike; ++t )
    {
        const float *p = displacement( mesh, t, a ), *q = displacement( mesh, t, b );
        alike = p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
    }
    return alike;
}

static uint64_t mix( uint64_t hash, uint32_t word )
{
    hash = ( hash ^ word ) * 0xff51afd7ed558ccdu;
    return hash ^ hash >> 32;
}

static uint64_t hash_of( const gltf_mesh* mesh, int v, const uint32_t key[WORDS] )
{
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for ( int i = 0; i < WORDS; ++i )
    {
        hash = mix( hash, key[i] );
    }
    for ( int t = 0; t < mesh->target_count; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float d = displacement( mesh, t, v )[k] + 0.0f;
            uint32_t word;
            memcpy( &word, &d, sizeof word );
            hash = mix( hash, word );
        }
    }
    return hash;
}

// What stays of the later vertex is counted.
static void compare_uvs( gltf_mesh* mesh, int first, int later, bool* is_seam )
{
    const float* uvs = mesh->mesh.uvs;
    if ( uvs != NULL && !is_seam[first] &&
         memcmp( uvs + 2 * (size_t)first, uvs + 2 * (size_t)later, 2 * sizeof *uvs ) != 0 )
    {
        is_seam[first] = true;
        ++mesh->mesh.uv_seam_count;
    }
}

static void keep( gltf_mesh* mesh, int from, int to )
{
    mesh->mesh.points[to] = mesh->mesh.points[from];
    if ( mesh->mesh.colours != NULL )
    {
        mesh->mesh.colours[to] = mesh->mesh.colours[from];
    }
    if ( mesh->mesh.uvs != NULL )
    {
        memmove( mesh->mesh.uvs + 2 * (size_t)to, mesh->mesh.uvs + 2 * (size_t)from, 2 * sizeof *mesh->mesh.uvs );
    }
    for ( int t = 0; t < mesh->target_count; ++t )
    {
        memmove( displacement( mesh, t, to ), displacement( mesh, t, from ), 3 * sizeof *mesh->targets );
    }
    if ( mesh->joints != NULL )
    {
        memmove( mesh->joints + 4 * (size_t)to, mesh->joints + 4 * (size_t)from, 4 * sizeof *mesh->joints );
        memmove( mesh->weights + 4 * (size_t)to, mesh->weights + 4 * (size_t)from, 4 * sizeof *mesh->weights );
    }
}

// Open addressing over the kept vertices, which move down as others are merged.
static void merge( gltf_mesh* mesh, int32_t* table, size_t slots, int32_t* number, bool* is_seam )
{
    int kept = 0;
    for ( int v = 0; v < mesh->mesh.vertex_count; ++v )
    {
        uint32_t key[WORDS], other[WORDS];
        key_of( mesh, v, key );
        size_t slot = hash_of( mesh, v, key ) & ( slots - 1 );
        for ( ; table[slot] != 0; slot = ( slot + 1 ) & ( slots - 1 ) )
        {
            key_of( mesh, table[slot] - 1, other );
            if ( memcmp( key, other, sizeof key ) == 0 && moves_alike( mesh, v, table[slot] - 1 ) )
            {
                break;
            }
        }
        if ( table[slot] != 0 )
        {
            number[v] = table[slot] - 1;
            compare_uvs( mesh, number[v], v, is_seam );
            continue;
        }
        keep( mesh, v, kept );
        number[v] = kept++;
        table[slot] = kept;
    }
    for ( int c = 0; c < 3 * mesh->mesh.triangle_count; ++c )
    {
        mesh->mesh.triangles[c] = number[mesh->mesh.triangles[c]];
    }
    for ( int t = 1; t < mesh->target_count; ++t )
    {
        memmove( mesh->targets + 3 * (size_t)t * (size_t)kept, displacement( mesh, t, 0 ),
                 3 * (size_t)kept * sizeof *mesh->targets );
    }
    mesh->merged_count = mesh->mesh.vertex_count - kept;
    mesh->mesh.vertex_count = kept;
}

wisp_status gltf_merge_seams( gltf_mesh* mesh, const char* name, wisp_error* error )
{
    const size_t count = (size_t)mesh->mesh.vertex_count;
    size_t slots = 16;
    while ( slots < 2 * count )
    {
        slots *= 2;
    }
    int32_t* table = calloc( slots, sizeof *table );
    int32_t* number = malloc( count * sizeof *number );
    bool* is_seam = calloc( count, sizeof *is_seam );
    const bool enough = table != NULL && number != NULL && is_seam != NULL;
    if ( enough )
    {
        merge( mesh, table, slots, number, is_seam );
    }
    free( table );
    free( number );
    free( is_seam );
    return enough ? WISP_OK
                  : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to merge %zu vertices",
                               io_short_name( name ), count );
}
