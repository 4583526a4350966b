#include "common/io/canvas.h"

#include <gmock/gmock.h>

namespace sgraphs {
namespace {

TEST(CanvasTest, SvgPutsPaperUnitsAtAThousandUserUnitsWithYUp) {
  const auto canvas = makeSvgCanvas({{-1, -1}, {3, 2}});
  canvas->line({0, 0}, {1, 2}, {255, 0, 16}, 0.02);
  canvas->text({0, 0}, "a<b", 0.72, {}, TextAnchor::kCenter);
  const std::string svg = canvas->encode();
  EXPECT_THAT(svg, testing::HasSubstr("width=\"40mm\" height=\"30mm\" viewBox=\"0 0 4000 3000\""));
  EXPECT_THAT(svg, testing::HasSubstr("stroke=\"#ff0010\" stroke-width=\"20\" points=\"1000,2000 2000,0\""));
  EXPECT_THAT(svg, testing::HasSubstr("font-size=\"1000\" text-anchor=\"middle\""));
  EXPECT_THAT(svg, testing::HasSubstr("a&lt;b"));
}

TEST(CanvasTest, SvgMergesRunsOfEqualCells) {
  const auto canvas = makeSvgCanvas({{0, 0}, {1, 1}});
  canvas->raster({{0, 0}, 0.1, 4, 1, {1, 1, 0, 1}, {{9, 9, 9}}});
  EXPECT_THAT(canvas->encode(), testing::HasSubstr("d=\"M0 900h200v100h-200zM300 900h100v100h-100z\""));
}

TEST(CanvasTest, PngKeepsItsSizeLimits) {
  const auto size = [](const std::string& png) {
    const auto at = [&](size_t i) { return static_cast<unsigned char>(png[i]); };
    // Width and height of the IHDR chunk, big-endian.
    return std::make_pair(at(18) * 256 + at(19), at(22) * 256 + at(23));
  };
  EXPECT_EQ(size(makePngCanvas({{0, 0}, {10, 5}}, 400, 1000)->encode()), std::make_pair(400, 200));
  EXPECT_EQ(size(makePngCanvas({{0, 0}, {10, 5}}, 4000, 20)->encode()), std::make_pair(200, 100));
}

TEST(CanvasTest, ViridisRunsFromVioletToYellow) {
  EXPECT_EQ(viridis(0).r, 68);
  EXPECT_EQ(viridis(1).r, 253);
  EXPECT_EQ(viridis(0.5).g, 144);
  EXPECT_EQ(viridis(7).b, 37);
}

}  // namespace
}  // namespace sgraphs
