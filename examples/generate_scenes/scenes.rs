//! The list of the scenes.

use super::{chang_shih, cornell, furnace, lischinski, paper_rooms, pyramid, room, two_rooms, vegetation};

/// Name and content of every file.
pub fn all() -> Vec<(String, String)> {
    [
        ("cornell", cornell::cornell()),
        ("furnace", furnace::furnace()),
        ("room", room::room()),
        ("two_rooms", two_rooms::two_rooms()),
        ("full_office", paper_rooms::full_office()),
        ("dining_room", paper_rooms::dining_room()),
        ("east_room", paper_rooms::east_room()),
        ("west_room", paper_rooms::west_room()),
        ("hevea", paper_rooms::hevea()),
        ("four_polygons", chang_shih::four_polygons()),
        ("living_room", chang_shih::living_room()),
        ("exhibit_room", lischinski::exhibit_room()),
        ("sunlit_room", lischinski::sunlit_room()),
        ("gallery", lischinski::gallery()),
        ("panelled_room", lischinski::panelled_room()),
        ("pyramid", pyramid::pyramid()),
        ("shrub", vegetation::shrub()),
    ]
    .into_iter()
    .flat_map(|(name, model)| {
        let (obj, mtl) = model.write(name);
        [(format!("{name}.obj"), obj), (format!("{name}.mtl"), mtl)]
    })
    .collect()
}
