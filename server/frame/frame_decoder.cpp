// zstd -> protobuf -> columns -> samples.
#include "server/frame/frame_decoder.hpp"

#include "server/frame/dictionary.hpp"
#include "server/frame/error.hpp"
#include "sweepcast/v1/scan.pb.h"
#include "sweepcast/v1/stream.pb.h"

#include <zstd.h>

#include <new>
#include <string>
#include <string_view>

namespace sweepcast::frame {

namespace {

struct FreeDecompressor {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

struct FreeDecompressorDictionary {
    void operator()(ZSTD_DDict* dictionary) const { ZSTD_freeDDict(dictionary); }
};

/// Ours, digested for decompression; one for all decoders.
const ZSTD_DDict* decompressor_dictionary() {
    static const std::unique_ptr<ZSTD_DDict, FreeDecompressorDictionary> dictionary(
        ZSTD_createDDict(dictionary_bytes().data(), dictionary_bytes().size())
    );
    if (!dictionary) {
        throw std::bad_alloc();
    }
    return dictionary.get();
}

}  // namespace

struct FrameDecoder::Workspace {
    Workspace() : context(ZSTD_createDCtx()) {
        if (!context) {
            throw std::bad_alloc();
        }
    }

    /// The body's scan, decompressed into `raw`.
    Result<std::string_view> decompress(const v1::Frame& frame) {
        const auto& body = frame.body();
        const auto raw_size = frame.raw_size();
        if (frame.dictionary() != 0 && frame.dictionary() != dictionary_id()) {
            return error_code(errc::dictionary_unknown);
        }
        ZSTD_DCtx_refDDict(
            context.get(),
            frame.dictionary() != 0 ? decompressor_dictionary() : nullptr
        );
        const auto own_size = ZSTD_getFrameContentSize(body.data(), body.size());
        if (own_size == ZSTD_CONTENTSIZE_ERROR) {
            return error_code(errc::compression_damaged);
        }
        if (own_size != raw_size) {  // or does not tell, which ours always do
            return error_code(errc::raw_size_wrong);
        }
        raw.resize(raw_size);
        const std::size_t size =
            ZSTD_decompressDCtx(context.get(), raw.data(), raw.size(), body.data(), body.size());
        if (ZSTD_isError(size) != 0) {
            return error_code(errc::compression_damaged);
        }
        if (size != raw_size) {
            return error_code(errc::raw_size_wrong);
        }
        return std::string_view(raw);
    }

    /// The serialised scan of `frame`, valid until the next one.
    Result<std::string_view> open(const v1::Frame& frame) {
        if (frame.raw_size() > max_raw_size) {
            return error_code(errc::raw_size_out_of_range);
        }
        switch (frame.compression()) {
        case v1::ZSTD:
            return decompress(frame);
        case v1::NONE:
            if (frame.body().size() != frame.raw_size()) {
                return error_code(errc::raw_size_wrong);
            }
            return std::string_view(frame.body());
        default:
            return error_code(errc::compression_unknown);
        }
    }

    std::unique_ptr<ZSTD_DCtx, FreeDecompressor> context;
    std::string raw;
    v1::Scan scan;
};

FrameDecoder::FrameDecoder() : workspace_(std::make_unique<Workspace>()) {}
FrameDecoder::FrameDecoder(FrameDecoder&&) noexcept = default;
FrameDecoder& FrameDecoder::operator=(FrameDecoder&&) noexcept = default;
FrameDecoder::~FrameDecoder() = default;

Result<DecodedScan> FrameDecoder::decode(const v1::Frame& frame) {
    auto& work = *workspace_;
    const auto raw = work.open(frame);
    if (!raw) {
        return raw.error();
    }
    if (!work.scan.ParseFromArray(raw->data(), static_cast<int>(raw->size()))) {
        return error_code(errc::scan_malformed);
    }
    return from_columns(work.scan);
}

}  // namespace sweepcast::frame
