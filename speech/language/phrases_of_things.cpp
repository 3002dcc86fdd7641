// SPDX-License-Identifier: Apache-2.0
#include "speech/language/phrases.h"

namespace engram::speech {

namespace {

constexpr Phrase kPhrasesOfThings[] = {
    {"your cameras", "you"},
    {"your camera", "you"},
    {"your eyes", "you"},
    {"your sensors", "you"},
    {"got anything", "do you hold anything"},
    {"got something", "do you hold something"},
    {"can be found", "is"},
    {"could be found", "is"},
    {"can i find", "is"},
    {"is to be found", "is"},
    {"all the things that you", "what you"},
    {"all the things you", "what you"},
    {"everything that you", "what you"},
    {"everything you", "what you"},
    {"all that you", "what you"},
    {"the things that you", "what you"},
    {"the things you", "what you"},
    {"all you", "what you"},
    {"have you got", "do you hold"},
    {"do you have", "do you hold"},
    {"did you have in", "did you hold in"},
    {"do you have in", "do you hold in"},
    {"in front of your eyes", "visible"},
    {"before your eyes", "visible"},
    {"come into view", "seen"},
    {"came into view", "seen"},
    {"come into sight", "seen"},
    {"came into sight", "seen"},
    {"come in sight", "seen"},
    {"caught sight of", "saw"},
    {"catch sight of", "see"},
    {"lay eyes on", "see"},
    {"laid eyes on", "saw"},
    {"set eyes on", "see"},
    {"come across", "see"},
    {"came across", "saw"},
    {"in front of", "at"},
    {"next to", "at"},
    {"close to", "at"},
    {"on top of", "on"},
    {"the place of", "location of"},
    {"current place of", "location of"},
    {"in one of your hands", "in your hand"},
    {"in either of your hands", "in your hand"},
    {"in any of your hands", "in your hand"},
    {"in either hand", "in your hand"},
    {"in your grip", "in your hand"},
    {"in your grasp", "in your hand"},
    {"in your possession", "in your hand"},
    {"a hold of", "hold of"},
    // Sight.
    {"make|made|making out", "see"},
    {"catch|caught|get|got|have|had|catching a|any? glimpse|sight|view of", "see"},
    {"catch|caught your eye|eyes|attention", "seen"},
    {"show|showed|shown|showing|shows|turn|turned|turns|crop|cropped up", "appeared"},
    {"show|showed|shown|showing|shows itself|themselves to? you?", "appeared"},
    {"pass|passed|passes|cross|crossed|crosses before|in|into? front? of? your|the? field? of? "
     "camera|cameras|eyes|path|view|sight|vision",
     "seen"},
    {"come|came|comes|coming before|into|in|within your|the? field? of? "
     "view|sight|vision|frame|picture|eyes|camera",
     "seen"},
    {"in|within|inside your|the|its|my field|range of view|vision|sight", "visible"},
    {"in|within your|the|its current|present? view|vision|sight|sights|frame|image|picture|photo",
     "visible"},
    {"in view|frame|sight|vision", "visible"},
    {"in front of you|yourself", "visible"},
    {"in front of|before your|the camera|cameras|eyes|lens", "visible"},
    {"have|has|had|having you? in your|the? view|sight", "see"},
    {"take|takes|took in", "take"},
    {"your|the camera|cameras|eyes|vision|view|sensors|image "
     "show|shows|showing|showed|shown|record|recorded|capture|captured|catch|caught|detect|detects|"
     "detected|take|takes|took|taken|taking|contain|find|found in?",
     "you see"},
    {"are you looking at", "do you see"},
    {"you are looking at", "do you see"},
    {"is|was there any|a|some? record|memory|evidence|trace|observation|sighting of you|your? "
     "seeing|having? seen?",
     "have you ever seen"},
    {"does|do|did|has your|the memory|log|records|record|database "
     "contain|contains|hold|have|include|show an|a|any? observation|sighting|record|trace of",
     "have you ever seen"},
    {"have a sighting of", "seen"},
    {"been observed|detected|seen by you", "been seen"},
    {"do you remember|recall seeing", "have you seen"},
    {"was there ever a? moment|time when|that|at? which? you", "did you ever"},
    {"no trace of", "not see"},
    // Hands.
    {"your fingers|grippers|fist", "your hand"},
    {"gripper|hand|hands content|contents", "what do you hold"},
    {"held objects|object|things|items|thing|item", "which objects held"},
    {"objects|things|items held|grasped|gripped at|in?", "which objects held"},
    {"in hand", "in your hand"},
    {"in one|either|any|both|some of your hands|grippers|hand", "in your hand"},
    {"in your grippers|gripper|hands|fingers|fist", "in your hand"},
    {"of the two grippers|hands|arms", "hand"},
    {"are you gripping|grasping|clutching", "do you hold"},
    {"were you gripping|clutching", "were you holding"},
    {"be gripping|clutching", "be holding"},
    {"is|are currently? grasped|gripped", "is held"},
    {"that is|are grasped|gripped", "you hold"},
    {"close|closed|closing on|round|around", "grasp"},
    {"let|letting go of", "put down"},
    // Places.
    {"located|positioned|situated|lying|resting|standing|sitting on top? of?", "lying on"},
    {"located|positioned|situated at|in", "lying at"},
    {"located", "lying"},
    {"can|could|would|will|may|might one|i|we|anyone|anybody find", "is"},
    {"will|would|can|could one|i|we find", "is"},
    {"content|contents of", "what is on"},
    {"parked|stationed|waiting|hanging yourself|around|about?", "standing"},
    {"base position|pose|location", "your position"},
    {"your base|wheels|platform", "you"},
    {"carry you", "drive"},
    {"your presence at|in|near", "you were at"},
    {"in motion", "moving"},
    {"have|has|had|having got? on top of it", "be on"},
};

}  // namespace

std::span<const Phrase> phrases_of_things() {
  return kPhrasesOfThings;
}

}  // namespace engram::speech
