// What the faces around rows of quads tell of them: normals, and creases that continue.
#pragma once

#include "tripatch/fill/fill_context.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// A fill of quads with the faces at its rim, numbered again.
class RowsInMesh {
public:
  RowsInMesh(const FillContext& context, const Fill& quads);
  /// Unit normals at the rim and at the new vertices, of all faces there.
  Points normals_of_rim() const;
  Points normals_of_new() const;
  /// Edges inside, numbered as the fill's, on which creases that end at the rim, or edges of flat walls (see find_features), go straight
  /// on as far as the fill is sharp there.
  std::vector<std::array<Index, 2>> creases() const;

private:
  bool is_sharp(Index from, Index to) const;
  bool is_inside(Index from, Index to) const;
  /// The vertex straight on where four quads meet, else -1.
  Index straight_on(Index from, Index to) const;

  const FillContext& ground_;
  const Fill& fill_;
  Index rim_, own_;              ///< how many vertices the rim has, and the fill
  Faces faces_;                  ///< the fill's, then those beyond
  std::vector<Index> vertices_;  ///< as the fill numbers them: of the rim, new ones, then those beyond
  Points points_;
  Connectivity around_;
};

}  // namespace tripatch
