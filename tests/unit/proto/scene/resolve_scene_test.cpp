// The scene with all defaults filled in.

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>

#include <functional>

#include "proto/scene/field_facts.hpp"
#include "proto/scene/read_scene.hpp"
#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::IsEmpty;

v1::Scene read(const std::string& text) {
  return read_scene_text(text, "scene.txtpb", {}).file.scene;
}

TEST(ResolvedScene, FillsInTheDefaultsOfWhatIsThere) {
  const v1::Scene scene = read(resolved_scene_text(read(good_scene)));
  EXPECT_TRUE(scene.flow().glottis().has_stations());
  EXPECT_EQ(scene.flow().glottis().stations(), 140);
  EXPECT_EQ(scene.solid().body(0).vocal_fold().elements_z(), 12);
  EXPECT_TRUE(scene.solid().kick(0).velocity().has_x());
  EXPECT_EQ(scene.coupling().iqn_ils().columns_max(), 50);
}

TEST(ResolvedScene, LeavesOutWhatIsNot) {
  const v1::Scene scene = read(resolved_scene_text(read(good_scene)));
  EXPECT_FALSE(scene.solid().has_time_integration());
  EXPECT_FALSE(scene.output().has_checkpoints());
  EXPECT_FALSE(scene.output().has_results_interval());
  EXPECT_FALSE(scene.coupling().iqn_ils().has_first_relaxation());
  EXPECT_FALSE(scene.solid().body(0).has_box());
}

TEST(ResolvedScene, IsASceneWithoutComplaints) {
  EXPECT_THAT(complaints_about(resolved_scene_text(read(good_scene))), IsEmpty());
}

TEST(ResolvedScene, DoesNotChangeWhenResolvedAgain) {
  const std::string text = resolved_scene_text(read(good_scene));
  EXPECT_EQ(resolved_scene_text(read(text)), text);
}

TEST(ResolvedScene, KeepsEveryBitOfANumber) {
  v1::Scene scene = read(good_scene);
  for (const double number : {1.0 / 3, 0.1 + 0.2, 5e-324, 1.7976931348623157e308, 123456789.123456789}) {
    scene.mutable_time()->set_end(number);
    EXPECT_EQ(read(resolved_scene_text(scene)).time().end(), number);
  }
}

TEST(ResolvedScene, KeepsEveryCharacterOfAText) {
  v1::Scene scene = read(good_scene);
  scene.set_title("\"quoted\" \\ 3\xC2\xB5m\n\t'");
  EXPECT_EQ(read(resolved_scene_text(scene)).title(), scene.title());
}

TEST(ResolvedScene, NamesItsSchemaAndTheBuild) {
  const std::string text = resolved_scene_text(read(good_scene));
  EXPECT_EQ(text.find("# proto-file: couplet/v1/scene.proto\n# proto-message: couplet.v1.Scene\n# All defaults"), 0U);
}

// What put_scalar, the checks and the defaults know: everything that the schema of a scene uses.
TEST(ResolvedScene, SchemaUsesOnlyTypesThatTheSceneLanguageHas) {
  std::function<void(const Descriptor&)> walk = [&](const Descriptor& message) {
    for (int i = 0; i < message.field_count(); ++i) {
      const FieldDescriptor& field = *message.field(i);
      switch (field.cpp_type()) {
        case FieldDescriptor::CPPTYPE_MESSAGE:
          walk(*field.message_type());
          break;
        case FieldDescriptor::CPPTYPE_BOOL:
        case FieldDescriptor::CPPTYPE_DOUBLE:
        case FieldDescriptor::CPPTYPE_ENUM:
        case FieldDescriptor::CPPTYPE_INT32:
        case FieldDescriptor::CPPTYPE_STRING:
          break;
        default:
          ADD_FAILURE() << field.full_name() << " has a type that no other field of a scene has";
      }
    }
  };
  walk(*v1::Scene::descriptor());
}

}  // namespace
}  // namespace couplet::scene
