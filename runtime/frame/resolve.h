// Inside the runtime only: what came back of a frame, into a picture.
#pragma once

#include "runtime/frame/frame_images.h"
#include "runtime/view/picture.h"

namespace dmvv::runtime {

/// A picture of the view's size in which nothing is seen.
Picture empty_picture(const View& view);

/// Puts a tile into the picture; colours are the mean of samples^2, all else is sample (0, 0). Cost: linear in pixels.
void resolve_tile(const TilePixels& from, const Tile& tile, const FrameSetup& setup, std::uint32_t samples,
                  Picture& picture);

}  // namespace dmvv::runtime
