/// A mesh that FUZZ_READ, a reader, makes of any bytes: rejected with a message, or read, examined, repaired, described, written and read
/// back.
#pragma once

#include "fuzz.h"

#include "mesh_internal.h"

typedef wisp_status fuzz_writer( FILE* out, const wisp_mesh* mesh, const char* name, wisp_error* error );
typedef wisp_status fuzz_reader( const void* bytes, size_t size, const char* name, wisp_mesh* out,
                                 wisp_error* error );

static inline void fuzz_round_trip( const wisp_mesh* mesh, fuzz_writer* write, fuzz_reader* read )
{
    char* bytes = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &bytes, &size );
    demand( stream != NULL );
    demand( write( stream, mesh, "fuzz", NULL ) == WISP_OK );
    fclose( stream );
    wisp_mesh again;
    demand( read( bytes, size, "again", &again, NULL ) == WISP_OK );
    free( bytes );
    demand( again.vertex_count == mesh->vertex_count && again.triangle_count == mesh->triangle_count );
    size_t points = (size_t)mesh->vertex_count * sizeof *mesh->points;
    size_t triangles = (size_t)mesh->triangle_count * 3 * sizeof *mesh->triangles;
    demand( memcmp( again.points, mesh->points, points ) == 0 );
    demand( memcmp( again.triangles, mesh->triangles, triangles ) == 0 );
    demand( ( again.colours != NULL ) == ( mesh->colours != NULL ) );
    demand( mesh->colours == NULL || memcmp( again.colours, mesh->colours, points ) == 0 );
    // Texture coordinates of OBJ belong to corners: those of a vertex without a triangle are lost.
    demand( mesh->uvs == NULL || again.uvs != NULL );
    for ( int c = 0; mesh->uvs != NULL && c < 3 * mesh->triangle_count; ++c )
    {
        const size_t at = 2 * (size_t)mesh->triangles[c];
        demand( memcmp( again.uvs + at, mesh->uvs + at, 2 * sizeof( float ) ) == 0 );
    }
    wisp_mesh_release( &again );
}

static inline void fuzz_examine( const wisp_mesh* mesh )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    demand( stream != NULL );
    demand( wisp_mesh_info( stream, mesh, "fuzz" ) == WISP_OK );
    fclose( stream );
    free( text );
}

/// A repair has the documented effect, or is rejected with a message and leaves the mesh unchanged.
static inline void fuzz_repair( wisp_mesh* mesh )
{
    wisp_mesh_repairs repairs;
    wisp_mesh_diagnostics report;
    wisp_error error = { .status = WISP_OK };
    int triangle_count = mesh->triangle_count;
    if ( wisp_mesh_repair( mesh, WISP_MESH_REPAIR_ALL, 0.0f, &repairs, &error ) != WISP_OK )
    {
        demand( error.message[0] != 0 && repairs.kept == NULL && mesh->triangle_count == triangle_count );
        return;
    }
    demand( wisp_mesh_examine( mesh, &report, NULL ) == WISP_OK );
    demand( wisp_mesh_require( &report, WISP_MESH_CLEAN, "fuzz", NULL ) == WISP_OK );
    demand( report.windings.count == 0 && repairs.kept_count == mesh->vertex_count );
    wisp_mesh_repairs_release( &repairs );
    triangle_count = mesh->triangle_count;
    if ( wisp_mesh_repair( mesh, WISP_MESH_WELD | WISP_MESH_FLIP, 0.0f, &repairs, &error ) != WISP_OK )
    {
        demand( error.message[0] != 0 && repairs.became == NULL && mesh->triangle_count == triangle_count );
        return;
    }
    demand( repairs.kept_count == mesh->vertex_count && repairs.unreferenced_dropped == 0 );
    demand( repairs.original_count == mesh->vertex_count + repairs.vertices_welded );
    demand( repairs.triangles_flipped == mesh->triangle_count );
    demand( triangle_count == mesh->triangle_count + repairs.collapsed_dropped );
    wisp_mesh_repairs_release( &repairs );
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    const wisp_status status = FUZZ_READ( data, size, "fuzz", &mesh, &error );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        demand( mesh.points == NULL && mesh.triangles == NULL );
        return 0;
    }
    fuzz_examine( &mesh );
    fuzz_round_trip( &mesh, mesh_put_ply, wisp_mesh_read_ply );
    fuzz_round_trip( &mesh, mesh_put_obj, wisp_mesh_read_obj );
    fuzz_repair( &mesh );
    wisp_mesh_release( &mesh );
    return 0;
}
