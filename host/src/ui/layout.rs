//! Which views lie where: tabs that can be dragged, and what is remembered of them.

use egui_tiles::{
    Behavior, Container, Linear, LinearDir, SimplificationOptions, Tile, TileId, Tiles, Tree,
};
use serde::{Deserialize, Serialize};

use super::viewer::Views;
use crate::plot::View;

/// A view in a tab.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(super) enum Pane {
    Lit,
    Compare,
    Convergence,
    Polar,
    ThetaV,
    ThetaH,
    ThetaD,
    Albedo,
    Slice,
    Lobe,
    Sampling,
    Numerics,
    Environment,
    Editor,
}

impl Pane {
    pub(super) const ALL: [Self; 14] = [
        Self::Lit,
        Self::Compare,
        Self::Convergence,
        Self::Polar,
        Self::ThetaV,
        Self::ThetaH,
        Self::ThetaD,
        Self::Albedo,
        Self::Slice,
        Self::Lobe,
        Self::Sampling,
        Self::Numerics,
        Self::Environment,
        Self::Editor,
    ];

    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Lit => "Lit object",
            Self::Compare => "Compare",
            Self::Convergence => "Convergence",
            Self::Polar => "Polar",
            Self::ThetaV => "Theta v",
            Self::ThetaH => "Theta h",
            Self::ThetaD => "Theta d",
            Self::Albedo => "Albedo",
            Self::Slice => "Image slice",
            Self::Lobe => "3D lobe",
            Self::Sampling => "Sampling",
            Self::Numerics => "Numerics",
            Self::Environment => "Environment",
            Self::Editor => "Editor",
        }
    }

    /// The plot that it shows.
    pub(super) fn view(self) -> Option<View> {
        match self {
            Self::Lit
            | Self::Compare
            | Self::Convergence
            | Self::Sampling
            | Self::Numerics
            | Self::Environment
            | Self::Editor => None,
            Self::Polar => Some(View::Polar),
            Self::ThetaV => Some(View::ThetaV),
            Self::ThetaH => Some(View::ThetaH),
            Self::ThetaD => Some(View::ThetaD),
            Self::Albedo => Some(View::Albedo),
            Self::Slice => Some(View::Slice),
            Self::Lobe => Some(View::Lobe),
        }
    }
}

/// The lit object on the left, lobe and plots over the slice on the right.
pub(super) fn usual() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut tabs = |panes: &[Pane]| {
        let children = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
        tiles.insert_tab_tile(children)
    };
    let lit = tabs(&[Pane::Lit, Pane::Compare, Pane::Environment, Pane::Convergence, Pane::Editor]);
    let above = tabs(&[Pane::Polar, Pane::ThetaV, Pane::ThetaH, Pane::ThetaD, Pane::Albedo]);
    let below = tabs(&[Pane::Lobe, Pane::Slice, Pane::Sampling, Pane::Numerics]);
    let mut column = Linear::new(LinearDir::Vertical, vec![above, below]);
    column.shares.set_share(above, 0.5);
    column.shares.set_share(below, 0.5);
    let column = tiles.insert_container(Container::Linear(column));
    let mut row = Linear::new(LinearDir::Horizontal, vec![lit, column]);
    row.shares.set_share(lit, 0.55);
    row.shares.set_share(column, 0.45);
    let root = tiles.insert_container(Container::Linear(row));
    Tree::new(egui::Id::unique("views"), root, tiles)
}

/// A layout that was written by [`to_text`]; none where it is none, or lacks the views.
pub(super) fn from_text(text: &str) -> Option<Tree<Pane>> {
    let tree: Tree<Pane> = serde_json::from_str(text).ok()?;
    let root = tree.root()?;
    tree.tiles.get(root)?;
    Some(tree)
}

pub(super) fn to_text(tree: &Tree<Pane>) -> String {
    serde_json::to_string(tree).unwrap_or_default()
}

/// Where a view lies, if it lies anywhere.
pub(super) fn find(tree: &Tree<Pane>, pane: Pane) -> Option<TileId> {
    tree.tiles.find_pane(&pane)
}

/// Shows a view: its tab comes to the front, and one that was closed comes back.
pub(super) fn show(tree: &mut Tree<Pane>, pane: Pane) {
    let id = match find(tree, pane) {
        Some(id) => id,
        None => {
            let id = tree.tiles.insert_pane(pane);
            let tabs = tree.tiles.tile_ids().find(|id| {
                matches!(tree.tiles.get(*id), Some(Tile::Container(Container::Tabs(_))))
            });
            match tabs.or(tree.root()) {
                Some(parent) => tree.move_tile_to_container(id, parent, usize::MAX, true),
                None => tree.root = Some(tree.tiles.insert_tab_tile(vec![id])),
            }
            id
        }
    };
    tree.make_active(|tile, _| tile == id);
}

/// Draws the views for the tree.
impl Behavior<Pane> for Views<'_> {
    fn pane_ui(&mut self, ui: &mut egui::Ui, _: TileId, pane: &mut Pane) -> egui_tiles::UiResponse {
        egui::Frame::central_panel(ui.style())
            .inner_margin(6.0)
            .show(ui, |ui| self.view_ui(ui, *pane));
        egui_tiles::UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        pane.title().into()
    }

    fn is_tab_closable(&self, _: &Tiles<Pane>, _: TileId) -> bool {
        true
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..Default::default() }
    }
}
