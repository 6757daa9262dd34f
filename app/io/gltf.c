// glTF files: bytes that are safe to parse, relations between elements, and meshes by name.
#include "gltf_internal.h"
#include "io_file.h"

#include <stdlib.h>
#include <string.h>

// ---- info ----

// The text of `wisp info` for a glTF file.

static void print_mesh_stats( FILE* out, const gltf_mesh* mesh )
{
    if ( mesh->skipped_count > 0 )
    {
        fprintf( out, "  note: primitives of points or lines, which are skipped: %d\n", mesh->skipped_count );
    }
    if ( mesh->merged_count > 0 )
    {
        fprintf( out, "  note: vertices of equal position and weights, merged: %d\n", mesh->merged_count );
    }
    if ( mesh->dropped_influence_count > 0 )
    {
        fprintf( out, "  note: vertices with more than four weights, of which the largest are kept: %d\n",
                 mesh->dropped_influence_count );
    }
}

static void print_skins( FILE* out, const gltf_model* model )
{
    for ( int s = 0; s < model->skin_count; ++s )
    {
        const gltf_skin* skin = &model->skins[s];
        fprintf( out, "skin %s: %d joints\n", skin->name, skin->joint_count );
        for ( int j = 0; j < skin->joint_count; ++j )
        {
            const int node = skin->joints[j], parent = model->nodes[node].parent;
            fprintf( out, "  joint %d: %s%s%s\n", j, model->nodes[node].name, parent >= 0 ? ", under " : "",
                     parent >= 0 ? model->nodes[parent].name : "" );
        }
    }
}

static void print_animations( FILE* out, const gltf_model* model )
{
    for ( int a = 0; a < model->animation_count; ++a )
    {
        const gltf_animation* animation = &model->animations[a];
        fprintf( out, "animation %s: %.6g s, %d channels\n", animation->name, animation->duration,
                 animation->channel_count + animation->weights_count );
        if ( animation->skipped_count > 0 )
        {
            fprintf( out,
                     "  note: channels without a node, or of weights without morph targets, which are skipped: %d\n",
                     animation->skipped_count );
        }
    }
}

// Morph targets, and when the first animation shows each of them alone: the frames of a recording.
static void print_targets( FILE* out, const gltf_model* model, int n )
{
    const gltf_mesh* mesh = &model->meshes[model->nodes[n].mesh];
    if ( mesh->target_count > 0 )
    {
        fprintf( out, "  morph targets: %d\n", mesh->target_count );
    }
    for ( int t = 0; t < mesh->target_count && t < WISP_MESH_LISTED; ++t )
    {
        const double time = model->animation_count > 0 ? gltf_target_time( model, n, 0, t ) : -1.0;
        fprintf( out, "    target %d, %s", t, mesh->target_names[t] );
        if ( time >= 0.0 )
        {
            fprintf( out, ", at %.6g s", time );
        }
        fputc( '\n', out );
    }
    if ( mesh->target_count > WISP_MESH_LISTED )
    {
        fprintf( out, "    and %d more\n", mesh->target_count - WISP_MESH_LISTED );
    }
}

static wisp_status print_node( FILE* out, const gltf_model* model, int n, const char* name )
{
    const gltf_node* node = &model->nodes[n];
    const gltf_mesh* mesh = &model->meshes[node->mesh];
    char title[400];
    snprintf( title, sizeof title, "%s#%s", name, node->name );
    if ( mesh->mesh.triangle_count == 0 )
    {
        fprintf( out, "%s: no triangles\n", title );
        print_mesh_stats( out, mesh );
        return WISP_OK;
    }
    wisp_mesh placed;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = gltf_mesh_at_rest( model, n, name, &placed, &error );
    if ( status != WISP_OK )
    {
        fprintf( out, "%s: %s\n", title, error.message );
        return status;
    }
    status = wisp_mesh_info( out, &placed, title );
    wisp_mesh_release( &placed );
    fprintf( out, "  mesh %s of %d %s", mesh->name, mesh->primitive_count,
             mesh->primitive_count == 1 ? "primitive" : "primitives" );
    fprintf( out, node->skin >= 0 ? ", skin %s\n" : "\n", node->skin >= 0 ? model->skins[node->skin].name : "" );
    print_targets( out, model, n );
    print_mesh_stats( out, mesh );
    return status;
}

wisp_status gltf_info( FILE* out, const gltf_model* model, const char* name )
{
    io_numbers numbers = { 0 };
    const wisp_status plain = io_numbers_begin( &numbers, NULL );
    fprintf( out, "%s: glTF, %d nodes, %d meshes, %d skins, %d animations\n", name, model->node_count,
             model->mesh_count, model->skin_count, model->animation_count );
    print_skins( out, model );
    print_animations( out, model );
    wisp_status status = WISP_OK;
    for ( int n = 0; n < model->node_count && status == WISP_OK; ++n )
    {
        status = model->nodes[n].mesh >= 0 ? print_node( out, model, n, name ) : WISP_OK;
    }
    if ( plain == WISP_OK )
    {
        io_numbers_end( &numbers );
    }
    return status;
}

// ---- merging ----

// Vertices that a file splits where normals or texture coordinates differ become one again: cloth must not fall apart
// at its seams. Only exactly equal positions with exactly equal joints, weights and displacements are the same vertex.

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
    io_memory scratch = { 0 };
    int32_t* table = io_get( &scratch, slots * sizeof *table );
    int32_t* number = io_get( &scratch, count * sizeof *number );
    bool* is_seam = io_get( &scratch, count * sizeof *is_seam );
    const bool enough = !scratch.is_short;
    if ( enough )
    {
        merge( mesh, table, slots, number, is_seam );
    }
    io_release( &scratch );
    return enough ? WISP_OK
                  : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory to merge %zu vertices",
                               io_short_name( name ), count );
}

// ---- files ----

#define _XOPEN_SOURCE 700

#include <math.h>
#include <strings.h>

#include "io_bytes.h"
#include "mesh_internal.h"

enum
{
    GLB_HEADER = 12,
    GLB_CHUNK = 8,
};

void gltf_release( gltf_model* model )
{
    if ( model != NULL )
    {
        io_release( &model->memory );
        *model = ( gltf_model ){ 0 };
    }
}

// ---- bytes -----------------------------------------------------------------------------------------------------

// The library reads nested values by recursion.
static wisp_status check_json( const char* text, size_t size, const char* name, wisp_error* error )
{
    int depth = 0;
    bool in_string = false;
    if ( size > GLTF_JSON_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %zu bytes of JSON, expected at most %zu", name, size,
                          GLTF_JSON_CAP );
    }
    for ( size_t i = 0; i < size; ++i )
    {
        const char c = text[i];
        if ( in_string )
        {
            i += c == '\\';
            in_string = c != '"';
            continue;
        }
        in_string = c == '"';
        depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
        if ( depth > GLTF_DEPTH_CAP )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: expected JSON nested at most %d deep", name, i,
                              GLTF_DEPTH_CAP );
        }
    }
    return WISP_OK;
}

static wisp_status check_binary( const unsigned char* bytes, size_t size, const char* name, wisp_error* error )
{
    if ( size < GLB_HEADER + GLB_CHUNK )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the file ends inside its header", name );
    }
    if ( io_get_u32( bytes + 4 ) != 2 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got version %u, expected 2", name, io_get_u32( bytes + 4 ) );
    }
    if ( io_get_u32( bytes + 8 ) != size )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %zu bytes, the header says %u", name, size,
                          io_get_u32( bytes + 8 ) );
    }
    const size_t json = io_get_u32( bytes + GLB_HEADER );
    if ( memcmp( bytes + GLB_HEADER + 4, "JSON", 4 ) != 0 || json > size - GLB_HEADER - GLB_CHUNK )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %d: expected a JSON part within the file", name,
                          GLB_HEADER );
    }
    const size_t rest = size - GLB_HEADER - GLB_CHUNK - json;
    const unsigned char* binary = bytes + GLB_HEADER + GLB_CHUNK + json;
    if ( rest > 0 && ( rest < GLB_CHUNK || io_get_u32( binary ) > rest - GLB_CHUNK ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: the binary part is longer than the file", name,
                          size - rest );
    }
    return check_json( (const char*)bytes + GLB_HEADER + GLB_CHUNK, json, name, error );
}

// ---- parts of a file -------------------------------------------------------------------------------------------

enum
{
    SIGNED_BYTE = 5120,
    UNSIGNED_BYTE,
    SIGNED_SHORT,
    UNSIGNED_SHORT,
    UNSIGNED_INT = 5125,
    SINGLE,
};

size_t gltf_component_size( int type )
{
    return type == SIGNED_BYTE || type == UNSIGNED_BYTE     ? 1
           : type == SIGNED_SHORT || type == UNSIGNED_SHORT ? 2
           : type == UNSIGNED_INT || type == SINGLE         ? 4
                                                            : 0;
}

double gltf_component( const unsigned char* at, int type, bool is_normalized )
{
    switch ( type )
    {
        case SIGNED_BYTE:
            return is_normalized ? fmax( (int8_t)*at / 127.0, -1.0 ) : (int8_t)*at;
        case UNSIGNED_BYTE:
            return is_normalized ? *at / 255.0 : *at;
        case SIGNED_SHORT:
            return is_normalized ? fmax( (int16_t)io_get_u16( at ) / 32767.0, -1.0 ) : (int16_t)io_get_u16( at );
        case UNSIGNED_SHORT:
            return is_normalized ? io_get_u16( at ) / 65535.0 : io_get_u16( at );
        case UNSIGNED_INT:
            return io_get_u32( at );
        default:
            return (double)io_get_float( at );
    }
}

bool gltf_normalize( double q[4] )
{
    const double length = sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
    for ( int k = 0; k < 4 && length > 1e-6; ++k )
    {
        q[k] /= length;
    }
    return length > 1e-6;
}

bool gltf_is_harmless( const char* extension )
{
    static const char* const starts[] = { "KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_mesh_quantization",
                                          "EXT_texture_" };
    bool is_harmless = false;
    for ( int i = 0; i < WISP_COUNT( starts ); ++i )
    {
        is_harmless = is_harmless || strncmp( extension, starts[i], strlen( starts[i] ) ) == 0;
    }
    return is_harmless;
}

bool gltf_is_image( const char* path )
{
    return io_has_extension( path, ".png" ) || io_has_extension( path, ".jpg" ) || io_has_extension( path, ".jpeg" );
}

wisp_status gltf_read_beside( const char* folder, const char* path, unsigned char** bytes, size_t* size,
                              wisp_error* error )
{
    const size_t length = folder != NULL ? strlen( folder ) : 0;
    const bool is_inside = folder != NULL && strncmp( path, folder, length ) == 0;
    const char* file = is_inside ? path + length : path;
    file += is_inside && file[0] == '/';
    if ( folder == NULL || file[0] == '\0' || file[0] == '/' || strstr( file, ".." ) != NULL ||
         strchr( file, ':' ) != NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "the buffer '%.64s' is not in the folder of the file", file );
    }
    return io_file_read( path, WISP_MESH_FILE_CAP, bytes, size, error );
}

// ---- relations -------------------------------------------------------------------------------------------------

// A node's turn comes when its parent has had its own; who never has one hangs in a circle.
static wisp_status sort_nodes( gltf_model* model, io_memory* scratch, const char* name, wisp_error* error )
{
    int32_t* depth = io_get( scratch, ( (size_t)model->node_count + 1 ) * sizeof *depth );
    int32_t* first = io_get( scratch, ( (size_t)model->node_count + 2 ) * sizeof *first ); // of each depth, behind it
    if ( scratch->is_short )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %d nodes", name, model->node_count );
    }
    for ( int n = 0; n < model->node_count; ++n )
    {
        // Up to the first ancestor of known depth, and down again.
        int steps = 0, at = n;
        for ( ; at >= 0 && depth[at] == 0 && steps <= model->node_count; at = model->nodes[at].parent )
        {
            ++steps;
        }
        if ( steps > model->node_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: node %d: it is its own ancestor", name, n );
        }
        int below = ( at >= 0 ? depth[at] : 0 ) + steps;
        for ( at = n; at >= 0 && depth[at] == 0; at = model->nodes[at].parent )
        {
            depth[at] = below--;
        }
    }
    for ( int n = 0; n < model->node_count; ++n )
    {
        ++first[depth[n] + 1];
    }
    for ( int d = 0; d <= model->node_count; ++d )
    {
        first[d + 1] += first[d];
    }
    for ( int n = 0; n < model->node_count; ++n )
    {
        model->order[first[depth[n]]++] = n;
    }
    return WISP_OK;
}

static wisp_status order_nodes( gltf_model* model, const char* name, wisp_error* error )
{
    io_memory scratch = { 0 };
    const wisp_status status = sort_nodes( model, &scratch, name, error );
    io_release( &scratch );
    return status;
}

// A weighted joint of a mesh is a joint of each skin that it has.
static wisp_status check_skins( const gltf_model* model, const char* name, wisp_error* error )
{
    for ( int n = 0; n < model->node_count; ++n )
    {
        const gltf_node* node = &model->nodes[n];
        const gltf_mesh* mesh = node->mesh >= 0 ? &model->meshes[node->mesh] : NULL;
        const gltf_skin* skin = node->skin >= 0 ? &model->skins[node->skin] : NULL;
        if ( mesh == NULL || skin == NULL )
        {
            continue;
        }
        if ( mesh->mesh.vertex_count > 0 && mesh->joints == NULL )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: node %d: it has a skin, but mesh %d has no weights", name,
                              n, node->mesh );
        }
        for ( int i = 0; i < 4 * mesh->mesh.vertex_count; ++i )
        {
            if ( mesh->joints[i] >= skin->joint_count )
            {
                return wisp_fail( error, WISP_BAD_INPUT, "%s: mesh %d: vertex %d: got joint %d, skin %d has %d", name,
                                  node->mesh, i / 4, mesh->joints[i], node->skin, skin->joint_count );
            }
        }
    }
    return WISP_OK;
}

static wisp_status finish( gltf_model* model, int flags, const char* name, wisp_error* error )
{
    wisp_status status = order_nodes( model, name, error );
    status = status == WISP_OK ? check_skins( model, name, error ) : status;
    for ( int m = 0; m < model->mesh_count && status == WISP_OK; ++m )
    {
        gltf_mesh* mesh = &model->meshes[m];
        status = mesh->mesh.vertex_count > 0 ? mesh_check( &mesh->mesh, name, error ) : WISP_OK;
        if ( status == WISP_OK && mesh->mesh.vertex_count > 0 && ( flags & GLTF_KEEP_SEAMS ) == 0 )
        {
            status = gltf_merge_seams( mesh, name, error );
        }
    }
    return status;
}

wisp_status gltf_read_bytes( const void* bytes, size_t size, const char* folder, const char* name, int flags,
                             gltf_model* out, wisp_error* error )
{
    *out = ( gltf_model ){ 0 };
    name = io_short_name( name );
    if ( size == 0 || size > INT32_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %zu bytes, expected 1 .. %d", name, size, INT32_MAX );
    }
    const bool is_binary = size >= 4 && memcmp( bytes, "glTF", 4 ) == 0;
    wisp_status status =
        is_binary ? check_binary( bytes, size, name, error ) : check_json( bytes, size, name, error );
    status = status == WISP_OK ? gltf_parse( bytes, size, is_binary, folder, name, out, error ) : status;
    status = status == WISP_OK ? finish( out, flags, name, error ) : status;
    if ( status != WISP_OK )
    {
        gltf_release( out );
    }
    return status;
}

wisp_status gltf_read( const char* path, int flags, gltf_model* out, wisp_error* error )
{
    *out = ( gltf_model ){ 0 };
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, WISP_MESH_FILE_CAP, &bytes, &size, error );
    if ( status == WISP_OK )
    {
        const size_t length = (size_t)( io_file_name( path ) - path );
        char* folder = malloc( length + 2 );
        if ( folder != NULL )
        {
            memcpy( folder, length > 0 ? path : "./", length > 0 ? length : 2 );
            folder[length > 0 ? length - 1 : 1] = '\0';
        }
        status = folder == NULL ? wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory", io_short_name( path ) )
                                : gltf_read_bytes( bytes, size, length == 1 ? "/" : folder, path, flags, out, error );
        free( folder );
    }
    free( bytes );
    return status;
}

// ---- meshes by name --------------------------------------------------------------------------------------------

static bool has_triangles( const gltf_model* model, int n )
{
    const int mesh = model->nodes[n].mesh;
    return mesh >= 0 && model->meshes[mesh].mesh.triangle_count > 0;
}

// As many names as fit.
static void list_names( const gltf_model* model, char* text, size_t size )
{
    size_t at = 0;
    text[0] = '\0';
    for ( int n = 0; n < model->node_count && at + 70 < size; ++n )
    {
        if ( has_triangles( model, n ) )
        {
            at += (size_t)snprintf( text + at, size - at, "%s%s", at > 0 ? ", " : "", model->nodes[n].name );
        }
    }
}

wisp_status gltf_find_mesh( const gltf_model* model, const char* wanted, const char* name, int* node,
                            wisp_error* error )
{
    int found[2] = { 0, 0 }, last[2] = { -1, -1 };
    for ( int n = 0; n < model->node_count; ++n )
    {
        if ( !has_triangles( model, n ) )
        {
            continue;
        }
        const char* own[2] = { model->nodes[n].name, model->meshes[model->nodes[n].mesh].name };
        for ( int k = 0; k < 2; ++k )
        {
            const bool same = wanted == NULL || strcmp( own[k], wanted ) == 0;
            found[k] += same;
            last[k] = same ? n : last[k];
        }
    }
    const int k = found[0] > 0 ? 0 : 1;
    *node = last[k];
    if ( found[k] == 1 )
    {
        return WISP_OK;
    }
    char names[200];
    list_names( model, names, sizeof names );
    name = io_short_name( name );
    return names[0] == '\0' ? wisp_fail( error, WISP_BAD_INPUT, "%s: no node has a mesh of triangles", name )
           : wanted != NULL
               ? wisp_fail( error, WISP_BAD_INPUT, "%s: got %d nodes with the mesh '%.60s', expected one of %s", name,
                            found[k], wanted, names )
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: got %d nodes with a mesh, expected the name of one behind #: %s", name, found[k],
                            names );
}

// Bytes of the path before the # of a name.
static size_t file_length( const char* path )
{
    const char* hash = strrchr( path, '#' );
    return hash != NULL ? (size_t)( hash - path ) : strlen( path );
}

bool gltf_is_path( const char* path )
{
    const size_t length = file_length( path );
    return ( length > 4 && strncasecmp( path + length - 4, ".glb", 4 ) == 0 ) ||
           ( length > 5 && strncasecmp( path + length - 5, ".gltf", 5 ) == 0 );
}

wisp_status gltf_model_read( const char* path, gltf_model* out, int* node, wisp_error* error )
{
    *out = ( gltf_model ){ 0 };
    const size_t length = file_length( path );
    const char* wanted = path[length] == '#' ? path + length + 1 : NULL;
    char* file = malloc( length + 1 );
    if ( file == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory", io_short_name( path ) );
    }
    memcpy( file, path, length );
    file[length] = '\0';
    wisp_status status = gltf_read( file, 0, out, error );
    status = status == WISP_OK ? gltf_find_mesh( out, wanted, file, node, error ) : status;
    free( file );
    if ( status != WISP_OK )
    {
        gltf_release( out );
    }
    return status;
}
