// Animations of nodes and of weights of morph targets.
#include "gltf_parse.h"

namespace gltf
{

namespace
{

gltf_interpolation take_interpolation( const string& kind, const string& where )
{
    if ( kind != "STEP" && kind != "LINEAR" && kind != "CUBICSPLINE" )
    {
        refuse( where,
                "got the interpolation " + printable( kind, "", 0 ) + ", expected STEP, LINEAR or CUBICSPLINE" );
    }
    return kind == "STEP" ? GLTF_STEP : kind == "LINEAR" ? GLTF_LINEAR : GLTF_CUBICSPLINE;
}

void check_times( const double* times, size_t count, const string& where )
{
    for ( size_t k = 0; k < count; ++k )
    {
        if ( times[k] < 0.0 || ( k > 0 && times[k] <= times[k - 1] ) )
        {
            refuse( where,
                    "key " + to_string( k ) + " at " + to_string( times[k] ) + " s is not after the one before" );
        }
    }
}

bool take_channel( const tinygltf::Model& model, const tinygltf::Animation& animation, size_t c, const string& where,
                   gltf_channel* out )
{
    const tinygltf::AnimationChannel& channel = animation.channels[c];
    const string& path = channel.target_path;
    const bool is_known = path == "translation" || path == "rotation" || path == "scale";
    if ( !is_known || channel.target_node == -1 )
    {
        return false;
    }
    check_element( channel.target_node, model.nodes.size(), where, "node" );
    check_element( channel.sampler, animation.samplers.size(), where, "sampler" );
    const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>( channel.sampler )];
    out->node = channel.target_node;
    out->path = path == "translation" ? GLTF_TRANSLATION : path == "rotation" ? GLTF_ROTATION : GLTF_SCALE;
    out->interpolation = take_interpolation( sampler.interpolation, where );
    const size_t width = out->path == GLTF_ROTATION ? 4 : 3, rows = out->interpolation == GLTF_CUBICSPLINE ? 3 : 1;
    const numbers times = take( model, sampler.input, 1, 1, where + ": times" );
    const numbers values = take( model, sampler.output, width, width, where + ": values" );
    if ( values.count != rows * times.count || times.count > INT32_MAX / 16 )
    {
        refuse( where, "got " + to_string( values.count ) + " values, expected " + to_string( rows * times.count ) +
                           ", for " + to_string( times.count ) + " keys" );
    }
    out->key_count = static_cast<int>( times.count );
    out->times = allocate<double>( times.count );
    out->values = allocate<double>( values.values.size() );
    std::memcpy( out->times, times.values.data(), times.count * sizeof( double ) );
    std::memcpy( out->values, values.values.data(), values.values.size() * sizeof( double ) );
    check_times( out->times, times.count, where );
    for ( size_t k = 0; k < times.count && out->path == GLTF_ROTATION; ++k )
    {
        normalize( out->values + ( rows * k + rows / 2 ) * 4, where + ": key " + to_string( k ) );
    }
    return true;
}

// Weights of a node with morph targets. Channels of one sampler share its arrays: a recording has one for all bodies.
bool take_weights_channel( const tinygltf::Model& model, const tinygltf::Animation& animation, size_t c,
                           const string& where, const gltf_model* known, size_t* left, gltf_animation* out )
{
    const tinygltf::AnimationChannel& channel = animation.channels[c];
    if ( channel.target_path != "weights" || channel.target_node == -1 )
    {
        return false;
    }
    check_element( channel.target_node, model.nodes.size(), where, "node" );
    check_element( channel.sampler, animation.samplers.size(), where, "sampler" );
    const int mesh = known->nodes[channel.target_node].mesh;
    const size_t width = mesh >= 0 ? static_cast<size_t>( known->meshes[mesh].target_count ) : 0;
    if ( width == 0 )
    {
        return false;
    }
    gltf_weights* weights = &out->weights[out->weights_count];
    for ( int w = 0; w < out->weights_count; ++w )
    {
        const gltf_weights* before = &out->weights[w];
        const gltf_mesh* of_before = &known->meshes[known->nodes[before->node].mesh];
        if ( before->sampler == channel.sampler && static_cast<size_t>( of_before->target_count ) == width )
        {
            *weights = *before;
            weights->node = channel.target_node;
            weights->is_shared = true;
            ++out->weights_count;
            return true;
        }
    }
    const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>( channel.sampler )];
    weights->node = channel.target_node;
    weights->sampler = channel.sampler;
    weights->interpolation = take_interpolation( sampler.interpolation, where );
    const size_t rows = weights->interpolation == GLTF_CUBICSPLINE ? 3 : 1;
    const numbers times = take( model, sampler.input, 1, 1, where + ": times" );
    const numbers values = take( model, sampler.output, 1, 1, where + ": values" );
    if ( times.count > INT32_MAX / 16 || values.count / width / rows != times.count ||
         values.count != times.count * width * rows )
    {
        refuse( where, "got " + to_string( values.count ) + " weights, expected one for each of " +
                           to_string( times.count ) + " keys and " + to_string( width ) + " morph targets" );
    }
    if ( values.count > *left )
    {
        refuse( where, "the weights of this file are the same bytes again and again" );
    }
    *left -= values.count;
    ++out->weights_count;
    weights->key_count = static_cast<int>( times.count );
    weights->times = allocate<double>( times.count );
    weights->values = allocate<float>( values.count );
    std::memcpy( weights->times, times.values.data(), times.count * sizeof( double ) );
    check_times( weights->times, times.count, where );
    for ( size_t k = 0; k < values.count; ++k )
    {
        weights->values[k] = static_cast<float>( values.values[k] );
    }
    out->duration = std::fmax( out->duration, weights->times[weights->key_count - 1] );
    return true;
}

} // namespace

void take_animation( const tinygltf::Model& model, size_t i, const gltf_model* known, size_t* left,
                     gltf_animation* out )
{
    const tinygltf::Animation& animation = model.animations[i];
    out->name = copy_text( printable( animation.name, "animation", i ) );
    out->channels = allocate<gltf_channel>( animation.channels.size() );
    out->weights = allocate<gltf_weights>( animation.channels.size() );
    for ( size_t c = 0; c < animation.channels.size(); ++c )
    {
        const string where = "animation " + to_string( i ) + ": channel " + to_string( c );
        if ( take_weights_channel( model, animation, c, where, known, left, out ) )
        {
            continue;
        }
        gltf_channel* channel = &out->channels[out->channel_count++];
        if ( take_channel( model, animation, c, where, channel ) )
        {
            out->duration = std::fmax( out->duration, channel->times[channel->key_count - 1] );
        }
        else
        {
            --out->channel_count;
            ++out->skipped_count;
        }
    }
}

} // namespace gltf
