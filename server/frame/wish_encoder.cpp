#include "server/frame/wish_encoder.hpp"

#include "server/frame/apply_wish.hpp"

namespace sweepcast::frame {

WireMessagePtr WishEncoder::encode(FrameContent content, const Wish& wish, std::size_t first) {
    content.kind = wish.kind;
    content.samples = apply_wish(wish, content.samples, first, samples_);
    if (wish.kind == Kind::sector && !content.last && content.samples.empty()) {
        return nullptr;
    }
    return encoder_.encode(content, wish.format);
}

}  // namespace sweepcast::frame
