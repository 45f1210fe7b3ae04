// SPDX-License-Identifier: Apache-2.0
// Recipes for the textures of rooms, furniture and clothes. All sizes in meters.
#pragma once

#include "synth/canvas.h"

namespace rds::synthetic {

void PaintPlaster(Canvas& canvas, Random& random, const Color& base);
// Wallpaper of scattered leaves, rings and bars over plaster.
void PaintWallpaper(Canvas& canvas, Random& random, const Color& base);
void PaintPlanks(Canvas& canvas, Random& random, const Color& base, double plank_width, double plank_length);
void PaintWood(Canvas& canvas, Random& random, const Color& base);
void PaintTiles(Canvas& canvas, Random& random, const Color& base, double tile);
void PaintRug(Canvas& canvas, Random& random);
void PaintPoster(Canvas& canvas, Random& random);
void PaintWindow(Canvas& canvas, Random& random);
void PaintWhiteboard(Canvas& canvas, Random& random);
void PaintScreen(Canvas& canvas, Random& random);
void PaintKeyboard(Canvas& canvas, Random& random);
void PaintBookshelf(Canvas& canvas, Random& random, const Color& wood, double shelf_height);
void PaintCabinet(Canvas& canvas, Random& random, const Color& base, int columns, int rows);
void PaintCarton(Canvas& canvas, Random& random);
void PaintPaperwork(Canvas& canvas, Random& random, const Color& wood);
void PaintFabric(Canvas& canvas, Random& random, const Color& base);
void PaintCeiling(Canvas& canvas, Random& random);
// Clothes, skin and hair, for wrapping round a body part.
void PaintShirt(Canvas& canvas, Random& random);
void PaintDenim(Canvas& canvas, Random& random);
void PaintFace(Canvas& canvas, Random& random, const Color& skin);
void PaintSkin(Canvas& canvas, Random& random, const Color& skin);

}  // namespace rds::synthetic
