/// Wisp in C++17: worlds and fabrics that release themselves, views as spans, one name for calls that differ only in their definition. A
/// header over the C functions: it allocates nothing, throws nothing and adds no state. Every function of C works beside it.
///
///     wisp::error error;
///     wisp::world world( error );                                 // every module, or wisp::world( def, error )
///     wisp_create_cloth_def def = wisp_default_create_cloth_def();
///     def.points = points, def.vertex_count = vertex_count;
///     ...
///     auto [status, cloth] = world.create( def );
///     while ( world.step( 1.0f / 60.0f ) == WISP_OK )
///         for ( const wisp_vec3& p : world.points( cloth ) )
///             draw( p );
#pragma once

#include "attachments.h"
#include "balloon.h"
#include "boundary.h"
#include "cloth.h"
#include "collision.h"
#include "contact.h"
#include "create.h"
#include "environment.h"
#include "frozen_hair.h"
#include "guide_hair.h"
#include "implicit_cloth.h"
#include "motion_constraints.h"
#include "membrane.h"
#include "seams.h"
#include "strand_appearance.h"
#include "strands.h"
#include "tearing.h"
#include "wisp/detail.h"
#include "wisp/fabric.h"
#include "wisp/moving_frame.h"
#include "wisp/sleep.h"
#include "wisp/wisp.h"

#include <cstddef>
#include <cstdint>

namespace wisp
{

/// Rows in memory of the engine, in the user's order: valid until the next call that changes the world, like wisp_view.
template <typename T> class span
{
  public:
    constexpr span() noexcept = default;
    constexpr span( T* data, std::size_t size ) noexcept : data_( data ), size_( size )
    {
    }

    constexpr T* data() const noexcept
    {
        return data_;
    }
    constexpr std::size_t size() const noexcept
    {
        return size_;
    }
    constexpr bool empty() const noexcept
    {
        return size_ == 0;
    }
    constexpr T* begin() const noexcept
    {
        return data_;
    }
    constexpr T* end() const noexcept
    {
        return data_ + size_;
    }
    constexpr T& operator[]( std::size_t i ) const noexcept
    {
        return data_[i];
    }

  private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

/// A status with its message; converts to true if there is one.
struct error : wisp_error
{
    error() noexcept : wisp_error{}
    {
    }
    explicit operator bool() const noexcept
    {
        return status != WISP_OK;
    }
};

/// What a call gives: a status, and a value that holds only with WISP_OK.
template <typename T> struct result
{
    wisp_status status = WISP_OK;
    T value{};

    explicit operator bool() const noexcept
    {
        return status == WISP_OK;
    }
};

/// A reference to a fabric; copies share it.
class fabric
{
  public:
    fabric() noexcept = default;
    fabric( const wisp_fabric_def& def, wisp_error& error ) noexcept
    {
        error = wisp_error{};
        wisp_fabric_cook( &def, nullptr, &handle_, &error );
    }
    fabric( const fabric& other ) noexcept : handle_( other.handle_ )
    {
        wisp_fabric_retain( handle_ );
    }
    fabric( fabric&& other ) noexcept : handle_( other.handle_ )
    {
        other.handle_ = nullptr;
    }
    fabric& operator=( fabric other ) noexcept
    {
        wisp_fabric* const mine = handle_;
        handle_ = other.handle_;
        other.handle_ = mine;
        return *this;
    }
    ~fabric()
    {
        wisp_fabric_release( handle_ );
    }

    wisp_fabric* get() const noexcept
    {
        return handle_;
    }
    explicit operator bool() const noexcept
    {
        return handle_ != nullptr;
    }

  private:
    wisp_fabric* handle_ = nullptr;
};

/// A world; moved, not copied. A world that could not be created is empty, and its calls return WISP_BAD_INPUT.
class world
{
  public:
    explicit world( wisp_error& error ) noexcept
    {
        wisp_world_def def = wisp_default_world_def();
        def.modules = wisp_all_modules( &def.module_count );
        error = wisp_error{};
        wisp_world_create( &def, &handle_, &error );
    }
    world( const wisp_world_def& def, wisp_error& error ) noexcept
    {
        error = wisp_error{};
        wisp_world_create( &def, &handle_, &error );
    }
    world( const world& ) = delete;
    world& operator=( const world& ) = delete;
    world( world&& other ) noexcept : handle_( other.handle_ )
    {
        other.handle_ = nullptr;
    }
    world& operator=( world&& other ) noexcept
    {
        world next( static_cast<world&&>( other ) ); // the old world ends with it
        wisp_world* const mine = handle_;
        handle_ = next.handle_;
        next.handle_ = mine;
        return *this;
    }
    ~world()
    {
        wisp_world_destroy( handle_ );
    }

    wisp_world* get() const noexcept
    {
        return handle_;
    }
    explicit operator bool() const noexcept
    {
        return handle_ != nullptr;
    }
    /// Message of the last call, empty if it did not fail.
    const char* message() const noexcept
    {
        return wisp_world_message( handle_ );
    }

    // ---- entities ----

    result<wisp_entity> create( const wisp_create_cloth_def& def ) noexcept
    {
        return added( wisp_create_cloth, def );
    }
    result<wisp_entity> create( const wisp_create_hair_def& def ) noexcept
    {
        return added( wisp_create_hair, def );
    }
    result<wisp_entity> add( const wisp_surface_def& def ) noexcept
    {
        return added( wisp_add_surface, def );
    }
    result<wisp_entity> add( const wisp_strands_def& def ) noexcept
    {
        return added( wisp_add_strands, def );
    }
    result<wisp_entity> add( const wisp_collider_def& def ) noexcept
    {
        return added( wisp_add_collider, def );
    }
    result<wisp_entity> add( const wisp_curves_def& def ) noexcept
    {
        return added( wisp_add_curves, def );
    }
    result<wisp_entity> instance( wisp_entity source, const wisp_transform& pose ) noexcept
    {
        result<wisp_entity> out;
        out.status = wisp_add_instance( handle_, source, &pose, &out.value );
        return out;
    }
    wisp_status remove( wisp_entity entity ) noexcept
    {
        return wisp_remove( handle_, entity );
    }
    bool is_alive( wisp_entity entity ) const noexcept
    {
        return wisp_is_alive( handle_, entity );
    }

    // ---- effects: one name, chosen by the definition ----

#define WISP_SET( name )                                                                                             \
    wisp_status set( wisp_entity e, const wisp_##name##_def& def ) noexcept                                          \
    {                                                                                                                \
        return wisp_set_##name( handle_, e, &def );                                                                  \
    }
    WISP_SET( cloth )
    WISP_SET( implicit_cloth )
    WISP_SET( balloon )
    WISP_SET( membrane )
    WISP_SET( tearing )
    WISP_SET( boundary )
    WISP_SET( collision )
    WISP_SET( contact )
    WISP_SET( motion_constraints )
    WISP_SET( moving_frame )
    WISP_SET( strand_dynamics )
    WISP_SET( strand_grid )
    WISP_SET( ghosts )
    WISP_SET( frozen_hair )
    WISP_SET( environment )
    WISP_SET( strand_appearance )
    WISP_SET( sleep )
    WISP_SET( detail )
#undef WISP_SET
    wisp_status set( const wisp_contact_settings& settings ) noexcept
    {
        return wisp_set_contact_settings( handle_, &settings );
    }

    // ---- before each step ----

    wisp_status pin( wisp_entity surface, const std::int32_t* vertices, int count ) noexcept
    {
        return wisp_pin( handle_, surface, vertices, count );
    }
    wisp_status unpin( wisp_entity surface, const std::int32_t* vertices, int count ) noexcept
    {
        return wisp_unpin( handle_, surface, vertices, count );
    }
    wisp_status move_pins( wisp_entity surface, const std::int32_t* vertices, const wisp_vec3* targets,
                           int count ) noexcept
    {
        return wisp_move_pins( handle_, surface, vertices, targets, count );
    }
    /// Move a collider, or the head of strands.
    wisp_status move( wisp_entity e, const wisp_transform& pose ) noexcept
    {
        return wisp_has_strands( handle_, e ) ? wisp_move_strand_head( handle_, e, pose )
                                              : wisp_move_collider( handle_, e, pose );
    }
    wisp_status set_wind( wisp_entity e, wisp_vec3 wind ) noexcept
    {
        return wisp_has_strands( handle_, e ) ? wisp_set_strand_wind( handle_, e, wind )
                                              : wisp_set_cloth_wind( handle_, e, wind );
    }
    wisp_status set_gravity( wisp_entity e, wisp_vec3 gravity ) noexcept
    {
        return wisp_has_strands( handle_, e ) ? wisp_set_strand_gravity( handle_, e, gravity )
                                              : wisp_set_gravity( handle_, e, gravity );
    }
    wisp_status teleport( wisp_entity e, const wisp_transform& motion, bool keep_velocity ) noexcept
    {
        return wisp_teleport( handle_, e, motion, keep_velocity );
    }

    // ---- steps ----

    wisp_status step( float dt ) noexcept
    {
        return wisp_world_step( handle_, dt );
    }
    /// @param before_step called as before_step( world ) before each step; must not throw
    template <typename F> wisp_status advance( float seconds, float dt, F&& before_step ) noexcept
    {
        struct call
        {
            world& self;
            F& function;
        } context{ *this, before_step };
        return wisp_world_advance(
            handle_, seconds, dt,
            []( void* user, wisp_world* )
            {
                call& c = *static_cast<call*>( user );
                c.function( c.self );
            },
            &context );
    }

    // ---- requests and views ----

    wisp_status request( wisp_entity entity, wisp_component component ) noexcept
    {
        return wisp_request( handle_, entity, component );
    }
    wisp_status cancel_request( wisp_entity entity, wisp_component component ) noexcept
    {
        return wisp_cancel_request( handle_, entity, component );
    }
    /// View a component as rows of T; empty if it was not requested, or if its rows have another size.
    template <typename T> span<const T> view( wisp_entity entity, wisp_component component ) noexcept
    {
        wisp_view out{};
        const bool is_good =
            wisp_world_view( handle_, entity, component, &out ) == WISP_OK && out.stride == sizeof( T );
        return is_good ? span<const T>( static_cast<const T*>( out.data ), static_cast<std::size_t>( out.count ) )
                       : span<const T>();
    }
    /// Points of a surface, or of strands.
    span<const wisp_vec3> points( wisp_entity entity ) noexcept
    {
        return view<wisp_vec3>( entity,
                                wisp_has_strands( handle_, entity ) ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS );
    }
    span<const wisp_vec3> normals( wisp_entity entity ) noexcept
    {
        return view<wisp_vec3>( entity, WISP_SURFACE_NORMALS );
    }
    result<wisp_motion_stats> motion_stats( wisp_entity entity ) noexcept
    {
        result<wisp_motion_stats> out;
        out.status = wisp_read_motion_stats( handle_, entity, &out.value );
        return out;
    }

    // ---- the world as a whole ----

    span<const wisp_profile_line> profile() const noexcept
    {
        const wisp_profile p = wisp_world_profile( handle_ );
        return span<const wisp_profile_line>( p.lines, static_cast<std::size_t>( p.count ) );
    }
    std::uint64_t counter( wisp_counter which ) const noexcept
    {
        return wisp_world_counter( handle_, which );
    }
    std::uint64_t hash() const noexcept
    {
        return wisp_world_hash( handle_ );
    }
    std::size_t snapshot_size() const noexcept
    {
        return wisp_world_snapshot_size( handle_ );
    }
    wisp_status snapshot( span<std::byte> out ) noexcept
    {
        return wisp_world_snapshot( handle_, out.data(), out.size() );
    }
    wisp_status restore( span<const std::byte> bytes ) noexcept
    {
        return wisp_world_restore( handle_, bytes.data(), bytes.size() );
    }

  private:
    template <typename Def>
    result<wisp_entity> added( wisp_status ( *function )( wisp_world*, const Def*, wisp_entity* ),
                               const Def& def ) noexcept
    {
        result<wisp_entity> out;
        out.status = function( handle_, &def, &out.value );
        return out;
    }

    wisp_world* handle_ = nullptr;
};

} // namespace wisp
