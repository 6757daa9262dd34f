// tinyobjloader alone. It reads words that are no numbers as 0 and accepts any index, so it gets only lines that
// mesh_obj_text.c has checked, one at a time, and its results are checked again there. The library is compiled in
// rather than linked, so that sanitizers and the fuzzer cover it.
#include "mesh_internal.h"

#include <exception>
#include <istream>
#include <new>
#include <streambuf>

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

namespace
{

// The library reads a stream; this one contains a single line of the file in place.
class line_buffer : public std::streambuf
{
  public:
    explicit line_buffer( const mesh_obj_feed& feed ) : feed_( feed )
    {
    }

    void stop()
    {
        stopped_ = true;
    }

    bool stopped() const
    {
        return stopped_;
    }

    const mesh_obj_feed& feed() const
    {
        return feed_;
    }

  protected:
    int_type underflow() override
    {
        static const char newline[] = "\n";
        const char* text = newline;
        size_t length = 1;
        // A line and its end are delivered separately, so that the library never reads past the current line.
        if ( !inside_line_ && ( stopped_ || !feed_.next_line( feed_.user, &text, &length ) || length == 0 ) )
        {
            return traits_type::eof();
        }
        inside_line_ = !inside_line_;
        // The interface requires writable pointers; reading never writes.
        char* begin = const_cast<char*>( text );
        setg( begin, begin, begin + length );
        return traits_type::to_int_type( *begin );
    }

  private:
    const mesh_obj_feed& feed_;
    bool stopped_ = false;
    bool inside_line_ = false;
};

void take_vertex( void* user, tinyobj::real_t x, tinyobj::real_t y, tinyobj::real_t z, tinyobj::real_t /*w*/ )
{
    line_buffer& buffer = *static_cast<line_buffer*>( user );
    if ( !buffer.stopped() && !buffer.feed().vertex( buffer.feed().user, wisp_vec3{ x, y, z } ) )
    {
        buffer.stop();
    }
}

void take_face( void* user, tinyobj::index_t* corners, int count )
{
    line_buffer& buffer = *static_cast<line_buffer*>( user );
    for ( int i = 0; i < count && !buffer.stopped(); ++i )
    {
        if ( !buffer.feed().corner( buffer.feed().user, corners[i].vertex_index, corners[i].texcoord_index,
                                    i + 1 == count ) )
        {
            buffer.stop();
        }
    }
}

wisp_status parse( const mesh_obj_feed& feed, const char* name, wisp_error* error )
{
    line_buffer buffer( feed );
    std::istream stream( &buffer );
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = take_vertex;
    callbacks.index_cb = take_face;
    std::string words;
    if ( !tinyobj::LoadObjWithCallback( stream, callbacks, &buffer, nullptr, nullptr, &words ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the OBJ library refused the file", name );
    }
    return WISP_OK;
}

} // namespace

// No exception leaves this file: its callers are C, which cannot clean up after one.
wisp_status mesh_obj_parse( const mesh_obj_feed* feed, const char* name, wisp_error* error )
{
    try
    {
        return parse( *feed, name, error );
    }
    catch ( const std::bad_alloc& )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for a line of the file", name );
    }
    catch ( const std::exception& problem )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the OBJ library refused the file: %.100s", name,
                          problem.what() );
    }
    catch ( ... )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: the OBJ library refused the file", name );
    }
}
