extern "C" {
#include "prep/import/dicom/dicom_image.h"
#include "formats/base/text.h"
#include "prep/import/dicom/dicom_j2k.h"
#include "prep/import/dicom/dicom_labels.h"
}

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dccodec.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <utility>
#include <vector>

struct dicom_reader {
    std::string path;
    DcmFileFormat file;
    Uint32 fragment; /* where the frame `next` begins */
    uint32_t next;   /* the frame that follows the last one read */
    uint32_t samples;
    bool planar;
    bool halves; /* of 32 bits, big endian: DCMTK swaps halves */
    bool j2k;
    dicom_j2k_form form;
    dicom_image image;
    std::vector<dicom_label> labels; /* of frames of binary segments, grouped */
};

namespace {

status failed(const char *path, const char *what, const OFCondition &why) {
    const status st = why == EC_MemoryExhausted ? ST_NOMEM : ST_CORRUPT;
    return status_describe(st, "%s: %s: DCMTK: %s", path, what, why.text());
}

/* Thrown for numbers that are present but cannot be read: going on would be wrong. */
struct unreadable {
    std::string name;
};

/* DCMTK itself throws nothing. */
template <typename Work> status guarded(const char *path, Work work) {
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return status_describe(ST_NOMEM, "%s: no memory for DCMTK", path);
    } catch (const unreadable &what) {
        return status_describe(ST_CORRUPT, "%s: %s: expected numbers", path, what.name.c_str());
    } catch (...) {
        return status_describe(ST_FAILED, "%s: DCMTK threw an exception", path);
    }
}

/* ---- elements ---- */

void get_text(DcmItem *item, const DcmTagKey &tag, char *to, size_t room) {
    OFString text;
    item->findAndGetOFString(tag, text);
    text_name(to, room, text.c_str());
}

bool there(DcmItem *item, const DcmTagKey &tag) {
    DcmElement *element = nullptr;
    return item->findAndGetElement(tag, element).good() && element->getLength() > 0;
}

[[noreturn]] void give_up(const DcmTagKey &key) {
    throw unreadable{DcmTag(key).getTagName()};
}

bool get_numbers(DcmItem *item, const DcmTagKey &tag, int count, double *out) {
    if (!there(item, tag))
        return false;
    for (int i = 0; i < count; i++) {
        Float64 v = 0;
        if (item->findAndGetFloat64(tag, v, (unsigned long)i).bad())
            give_up(tag);
        out[i] = v;
    }
    return true;
}

double get_number(DcmItem *item, const DcmTagKey &tag, double otherwise) {
    double v = otherwise;
    get_numbers(item, tag, 1, &v);
    return v;
}

uint32_t get_short(DcmItem *item, const DcmTagKey &tag, uint32_t otherwise) {
    Uint16 v = 0;
    return item->findAndGetUint16(tag, v).good() ? v : otherwise;
}

uint32_t get_frames(DcmItem *item) {
    Sint32 n = 1;
    return item->findAndGetSint32(DCM_NumberOfFrames, n).good() && n > 0 ? (uint32_t)n : 1;
}

/* ---- segments (PS3.3, A.51) ---- */

/* The highest segment number, counted from 1; 0: there are no segments. */
uint32_t most_segment(DcmItem *set, uint32_t &count) {
    DcmSequenceOfItems *segments = nullptr;
    uint32_t most = 0;
    count = 0;
    if (set->findAndGetSequence(DCM_SegmentSequence, segments).bad() || !segments)
        return 0;
    count = (uint32_t)segments->card();
    for (DcmObject *item = nullptr; (item = segments->nextInContainer(item));) {
        const uint32_t number = get_short(static_cast<DcmItem *>(item), DCM_SegmentNumber, 0);
        most = number > most ? number : most;
    }
    return most;
}

/* Set up segments: single bits become labels of 8 or 16 bits. */
void find_segments(DcmItem *set, dicom_image *image) {
    uint32_t count = 0;
    const uint32_t most = most_segment(set, count);
    if (count == 0 || image->allocated != 1)
        return;
    image->segments = count;
    image->allocated = image->stored = count > 1 && most > 255 ? 16 : 8;
    image->high = image->stored - 1;
    image->is_signed = false;
}

/* ---- what can be read ---- */

void refuse(dicom_image *image, const char *why, const char *what) {
    if (!image->refuse[0])
        snprintf(image->refuse, sizeof image->refuse, "%s%s", why, what);
}

bool is_j2k(E_TransferSyntax syntax) {
    return syntax == EXS_JPEG2000LosslessOnly || syntax == EXS_JPEG2000;
}

void check_syntax(DcmFileFormat &file, dicom_image *image) {
    const E_TransferSyntax syntax = file.getDataset()->getOriginalXfer();
    const DcmXfer transfer(syntax);
    text_name(image->syntax, sizeof image->syntax, transfer.getXferName());
    if (transfer.isEncapsulated() &&
        !DcmCodecList::canChangeCoding(syntax, EXS_LittleEndianExplicit) &&
        !(is_j2k(syntax) && dicom_j2k_is_there()))
        refuse(image, "no decoder here for ", image->syntax);
    if (is_j2k(syntax) && image->high + 1 != image->stored)
        refuse(image, "JPEG 2000 whose high bit is not that of its stored bits", "");
}

void check_pixels(DcmItem *set, uint64_t bytes, dicom_image *image) {
    char kind[32];
    get_text(set, DCM_PhotometricInterpretation, kind, sizeof kind);
    const uint32_t bits = image->allocated;
    if (image->columns == 0 || image->rows == 0)
        refuse(image, "no image", "");
    else if (bits != 8 && bits != 16 && bits != 32)
        refuse(image, "its numbers are not of 8, 16 or 32 bits", "");
    else if (image->stored < 1 || image->stored > bits || image->high + 1 < image->stored ||
             image->high >= bits)
        refuse(image, "bits stored and high bit do not fit bits allocated", "");
    else if (image->samples == 3 ? bits != 8 : image->samples != 1)
        refuse(image, "neither numbers nor colours of 8 bits", "");
    else if (strcmp(kind, "PALETTE COLOR") == 0)
        refuse(image, "indices into a palette", "");
    else if (set->tagExists(DCM_ModalityLUTSequence))
        refuse(image, "values by a table (Modality LUT Sequence)", "");
    else if ((uint64_t)image->frames * 8 > bytes + 8)
        refuse(image, "it is too short for so many frames", "");
}

/* ---- frames that are no slices ---- */

/* Returns whether the image is flat and cut into tiles: by its class, or by how its frames are
 * organised (PS3.3, C.7.6.17.3). */
bool is_tiled(DcmItem *set, const OFString &kind, const dicom_image *image) {
    OFString organised;
    set->findAndGetOFString(DCM_DimensionOrganizationType, organised);
    Uint32 whole = 0;
    set->findAndGetUint32(DCM_TotalPixelMatrixColumns, whole);
    return kind == UID_VLWholeSlideMicroscopyImageStorage ||
           organised.compare(0, 5, "TILED") == 0 || whole > image->columns;
}

bool has_frame_positions(DcmItem *set) {
    DcmItem *frame = nullptr;
    return set->tagExists(DCM_GridFrameOffsetVector) ||
           (set->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, frame, 0).good() &&
            frame->tagExists(DCM_PlanePositionSequence));
}

/* Returns whether frames follow one another in time (PS3.3, C.7.6.5 and C.7.6.6). */
bool is_cine(DcmItem *set, const dicom_image *image) {
    DcmElement *pointer = nullptr;
    if (image->frames < 2 || has_frame_positions(set))
        return false;
    if (set->findAndGetElement(DCM_FrameIncrementPointer, pointer).bad())
        return set->tagExists(DCM_FrameTime) || set->tagExists(DCM_FrameTimeVector);
    DcmAttributeTag *tags = dynamic_cast<DcmAttributeTag *>(pointer);
    DcmTagKey key;
    for (unsigned long i = 0; tags && tags->getTagVal(key, i).good(); i++)
        if (key == DCM_FrameTime || key == DCM_FrameTimeVector)
            return true;
    return false;
}

/* Refuse several fractional segments, which are no labels, and binary ones that cannot be read. */
void check_segments(DcmFileFormat &file, dicom_image *image) {
    DcmDataset *set = file.getDataset();
    OFString kind;
    uint32_t count = 0;
    most_segment(set, count);
    set->findAndGetOFString(DCM_SegmentationType, kind);
    if (count > 1 && kind == "FRACTIONAL")
        refuse(image,
               "several fractional segments in one file, which are no labels: a file for each can "
               "be read, and so can binary ones",
               "");
    if (!image->segments)
        return;
    if (DcmXfer(set->getOriginalXfer()).isEncapsulated())
        refuse(image, "single bits, compressed: `dcmdrle' undoes RLE", "");
    else if (image->samples != 1)
        refuse(image, "single bits of several colours", "");
    else if (!has_frame_positions(set))
        refuse(image, "segments whose frames have no positions", "");
}

void check_frames(DcmItem *set, const OFString &kind, dicom_image *image) {
    if (is_tiled(set, kind, image))
        refuse(image,
               "tiles of one flat picture (a whole slide image), side by side: no slices of "
               "a volume",
               "");
    else if (is_cine(set, image))
        refuse(image,
               "frames one after another in time (cine), of one place: no slices of a "
               "volume; `dcm2pnm +Fa' writes them as pictures",
               "");
}

void read_numbers(DcmItem *set, dicom_image *image) {
    image->columns = get_short(set, DCM_Columns, 0);
    image->rows = get_short(set, DCM_Rows, 0);
    image->frames = get_frames(set);
    image->samples = get_short(set, DCM_SamplesPerPixel, 1);
    image->allocated = get_short(set, DCM_BitsAllocated, 16);
    image->stored = get_short(set, DCM_BitsStored, image->allocated);
    image->high = get_short(set, DCM_HighBit, image->stored - 1);
    image->is_signed = get_short(set, DCM_PixelRepresentation, 0) == 1;
    find_segments(set, image);
}

/* JPEG 2000 decodes its own colour transforms to RGB. Other colour models stay as they are, and are
 * refused. */
status check_colours(DcmItem *set, const char *path, uint32_t samples) {
    char kind[32];
    get_text(set, DCM_PhotometricInterpretation, kind, sizeof kind);
    if (samples == 1 || strcmp(kind, "RGB") == 0 || strcmp(kind, "YBR_RCT") == 0 ||
        strcmp(kind, "YBR_ICT") == 0)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s: colours as %s are not read", path, kind);
}

void read_image(DcmFileFormat &file, uint64_t bytes, dicom_image *image) {
    DcmDataset *set = file.getDataset();
    OFString kind;
    if (file.getMetaInfo()->findAndGetOFString(DCM_MediaStorageSOPClassUID, kind).bad())
        set->findAndGetOFString(DCM_SOPClassUID, kind);
    image->dicom = !kind.empty();
    image->storage = dcmIsImageStorageSOPClassUID(kind.c_str());
    get_text(set, DCM_SeriesInstanceUID, image->series, sizeof image->series);
    get_text(set, DCM_SOPInstanceUID, image->instance, sizeof image->instance);
    get_text(set, DCM_SeriesDescription, image->description, sizeof image->description);
    get_text(set, DCM_Modality, image->modality, sizeof image->modality);
    read_numbers(set, image);
    check_syntax(file, image);
    check_frames(set, kind, image);
    check_segments(file, image);
    check_pixels(set, bytes, image);
}

/* ---- places of frames ---- */

/* The item of a functional group: the frame's, else that of all frames. NULL: neither exists. */
DcmItem *group_item(DcmItem *set, uint32_t frame, const DcmTagKey &group) {
    DcmItem *item = nullptr, *found = nullptr;
    if (set->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, item, (long)frame)
            .good() &&
        item->findAndGetSequenceItem(group, found, 0).good())
        return found;
    if (set->findAndGetSequenceItem(DCM_SharedFunctionalGroupsSequence, item, 0).good() &&
        item->findAndGetSequenceItem(group, found, 0).good())
        return found;
    return nullptr;
}

DcmItem *item_or_set(DcmItem *set, uint32_t frame, const DcmTagKey &group) {
    DcmItem *item = group_item(set, frame, group);
    return item ? item : set;
}

/* Move the place of a dose's frame along the normal by its offset. */
void offset_frame(DcmItem *set, uint32_t frame, dicom_place *p) {
    Float64 offset = 0;
    const double *a = p->across, *d = p->down;
    if (!there(set, DCM_GridFrameOffsetVector))
        return;
    if (set->findAndGetFloat64(DCM_GridFrameOffsetVector, offset, frame).bad())
        give_up(DCM_GridFrameOffsetVector);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        p->position[i] += offset * (a[j] * d[k] - a[k] * d[j]);
    }
}

void read_spacing(DcmItem *measures, dicom_place *p) {
    double rows_columns[2];
    p->between[0] = p->between[1] = 1;
    if (get_numbers(measures, DCM_PixelSpacing, 2, rows_columns) ||
        get_numbers(measures, DCM_ImagerPixelSpacing, 2, rows_columns)) {
        p->between[0] = rows_columns[1];
        p->between[1] = rows_columns[0];
    }
    p->apart = get_number(measures, DCM_SpacingBetweenSlices, 0);
}

void read_scale(DcmItem *set, uint32_t frame, dicom_place *p) {
    DcmItem *values = item_or_set(set, frame, DCM_PixelValueTransformationSequence);
    p->slope = get_number(values, DCM_RescaleSlope, 1);
    p->intercept = get_number(values, DCM_RescaleIntercept, 0);
    if (set->tagExists(DCM_DoseGridScaling))
        p->slope *= get_number(set, DCM_DoseGridScaling, 1);
}

void read_place(DcmItem *set, uint32_t frame, uint32_t frames, dicom_place *p) {
    double directions[6];
    DcmItem *position = item_or_set(set, frame, DCM_PlanePositionSequence);
    DcmItem *orientation = item_or_set(set, frame, DCM_PlaneOrientationSequence);
    *p = dicom_place{};
    p->known = get_numbers(position, DCM_ImagePositionPatient, 3, p->position) &&
               get_numbers(orientation, DCM_ImageOrientationPatient, 6, directions);
    if (p->known) {
        memcpy(p->across, directions, sizeof p->across);
        memcpy(p->down, directions + 3, sizeof p->down);
        offset_frame(set, frame, p);
    }
    read_spacing(item_or_set(set, frame, DCM_PixelMeasuresSequence), p);
    read_scale(set, frame, p);
    Sint32 number = 0;
    set->findAndGetSint32(DCM_InstanceNumber, number);
    p->number = frames > 1 ? (int)frame : (int)number;
    /* Several frames with one common position have no known places. */
    if (frames > 1 && position == set && !set->tagExists(DCM_GridFrameOffsetVector))
        p->known = false;
}

status tell_places(DcmItem *set, uint32_t frames, const dicom_places *places) {
    for (uint32_t i = 0; i < frames; i++) {
        dicom_place p;
        read_place(set, i, frames, &p);
        status st = places->take(places->ctx, i, &p);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* ---- labels ---- */

/* Number of the segment that a frame belongs to; 0: none is named. */
uint32_t segment_of(DcmItem *set, uint32_t frame) {
    DcmItem *named = group_item(set, frame, DCM_SegmentIdentificationSequence);
    return named ? get_short(named, DCM_ReferencedSegmentNumber, 0) : 0;
}

status find_labels(DcmItem *set, const char *path, const dicom_image &image,
                   std::vector<dicom_label> &labels) {
    for (uint32_t i = 0; i < image.frames; i++) {
        dicom_label one = {};
        one.frame = i;
        read_place(set, i, image.frames, &one.place);
        one.place.slope = 1;
        one.place.intercept = 0;
        one.segment = segment_of(set, i);
        if (image.segments == 1)
            one.segment = 1;
        if (!one.place.known || one.segment == 0 || one.segment >> image.stored)
            return status_describe(ST_CORRUPT,
                                   "%s: frame %u (counted from 0): expected its position and the "
                                   "number of its segment",
                                   path, i);
        labels.push_back(one);
    }
    dicom_labels_group(labels.data(), (uint32_t)labels.size());
    return ST_OK;
}

status tell_labels(DcmItem *set, const char *path, const dicom_image &image,
                   const dicom_places *places) {
    std::vector<dicom_label> labels;
    status st = find_labels(set, path, image, labels);
    if (st != ST_OK)
        return st;
    return dicom_labels_tell(labels.data(), (uint32_t)labels.size(), image.frames, places);
}

/* Get the bits of all frames. */
status find_bits(dicom_reader *r, const uint8_t **bits) {
    const char *path = r->path.c_str();
    DcmElement *element = nullptr;
    Uint8 *bytes = nullptr;
    OFCondition done = r->file.getDataset()->findAndGetElement(DCM_PixelData, element);
    if (done.good())
        done = element->getUint8Array(bytes);
    if (done.bad() || !bytes)
        return failed(path, "reading its pixels", done.bad() ? done : EC_CorruptedData);
    const uint64_t pixels = (uint64_t)r->image.rows * r->image.columns;
    const uint64_t has = (uint64_t)element->getLength() * 8;
    *bits = bytes;
    if (pixels * r->image.frames <= has)
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: its pixels have %llu bits, expected %llu", path,
                           (unsigned long long)has, (unsigned long long)(pixels * r->image.frames));
}

/* Put the labels of a group, from its first on, into an array of zeros. */
uint64_t put_group(const dicom_reader *r, const uint8_t *bits, const dicom_label *first,
                   void *numbers) {
    const dicom_label *end = r->labels.data() + r->labels.size();
    const size_t pixels = (size_t)r->image.rows * r->image.columns;
    uint64_t taken = 0;
    for (const dicom_label *at = first; at && at < end && at->group == first->group; at++)
        taken +=
            dicom_labels_put(bits, at->frame, pixels, at->segment, r->image.allocated, numbers);
    return taken;
}

status read_labels(dicom_reader *r, uint32_t frame, void *buffer, size_t size) {
    const uint8_t *bits = nullptr;
    status st = find_bits(r, &bits);
    if (st != ST_OK)
        return st;
    memset(buffer, 0, size);
    put_group(r, bits, dicom_labels_first(r->labels.data(), (uint32_t)r->labels.size(), frame),
              buffer);
    return ST_OK;
}

/* ---- pixels ---- */

/* Convert colour planes to colours side by side, using the second half of the buffer. */
void interleave(void *buffer, size_t size) {
    uint8_t *to = static_cast<uint8_t *>(buffer), *from = to + size;
    memcpy(from, to, size);
    for (size_t i = 0; i < size / 3; i++)
        for (size_t c = 0; c < 3; c++)
            to[3 * i + c] = from[c * (size / 3) + i];
}

/* Swap halves back: DCMTK treats a 32-bit number as two of 16, and swaps each one's bytes. */
void exchange_halves(void *buffer, size_t size) {
    uint16_t *half = static_cast<uint16_t *>(buffer);
    for (size_t i = 0; i + 1 < size / sizeof *half; i += 2)
        std::swap(half[i], half[i + 1]);
}

/* Free the decoded fragments. */
void forget_fragments(DcmPixelData *pixels, Uint32 from, Uint32 to) {
    DcmPixelSequence *sequence = nullptr;
    E_TransferSyntax syntax = EXS_Unknown;
    const DcmRepresentationParameter *parameter = nullptr;
    pixels->getOriginalRepresentationKey(syntax, parameter);
    if (!DcmXfer(syntax).isEncapsulated() ||
        pixels->getEncapsulatedRepresentation(syntax, parameter, sequence).bad() || !sequence)
        return;
    for (Uint32 i = from; i < to; i++) {
        DcmPixelItem *item = nullptr;
        if (sequence->getItem(item, i).good() && item)
            item->compact();
    }
}

/* Find the fragments of a frame: from r->fragment on, `to` behind the last. Either there is one per
 * frame, or one frame has all, or the offset table in front of them tells. */
OFCondition find_fragments(dicom_reader *r, DcmPixelSequence *sequence, uint32_t frame,
                           uint32_t frames, Uint32 &to) {
    const Uint32 all = (Uint32)sequence->card();
    r->fragment = 1;
    to = all;
    if (frames == 1)
        return EC_Normal;
    if (all == frames + 1) {
        r->fragment = frame + 1;
        to = frame + 2;
        return EC_Normal;
    }
    OFCondition done =
        DcmCodec::determineStartFragment(frame, (Sint32)frames, sequence, r->fragment);
    if (done.good() && frame + 1 < frames)
        done = DcmCodec::determineStartFragment(frame + 1, (Sint32)frames, sequence, to);
    return done;
}

status read_j2k(dicom_reader *r, DcmPixelData *pixels, uint32_t frame, void *buffer) {
    const char *path = r->path.c_str();
    DcmPixelSequence *sequence = nullptr;
    E_TransferSyntax syntax = EXS_Unknown;
    const DcmRepresentationParameter *parameter = nullptr;
    Uint32 to = 0;
    pixels->getOriginalRepresentationKey(syntax, parameter);
    OFCondition done = pixels->getEncapsulatedRepresentation(syntax, parameter, sequence);
    if (done.good())
        done = find_fragments(r, sequence, frame, get_frames(r->file.getDataset()), to);
    std::vector<Uint8> stream;
    for (Uint32 i = r->fragment; done.good() && i < to; i++) {
        DcmPixelItem *item = nullptr;
        Uint8 *bytes = nullptr;
        done = sequence->getItem(item, i);
        if (done.good())
            done = item->getUint8Array(bytes);
        if (done.good() && bytes)
            stream.insert(stream.end(), bytes, bytes + item->getLength());
    }
    if (done.bad())
        return failed(path, "finding a frame's pixels", done);
    const status st = dicom_j2k_decode(path, stream.data(), stream.size(), &r->form, buffer);
    forget_fragments(pixels, r->fragment, to);
    return st;
}

status read_frame(dicom_reader *r, uint32_t frame, void *buffer, size_t size) {
    const char *path = r->path.c_str();
    if (r->image.segments)
        return read_labels(r, frame, buffer, size);
    DcmDataset *set = r->file.getDataset();
    DcmElement *element = nullptr;
    OFCondition done = set->findAndGetElement(DCM_PixelData, element);
    DcmPixelData *pixels = dynamic_cast<DcmPixelData *>(element);
    if (done.bad() || !pixels)
        return status_describe(ST_CORRUPT, "%s: expected pixels (7fe0,0010)", path);
    Uint32 expected = 0;
    pixels->getUncompressedFrameSize(set, expected);
    if (expected != size)
        return status_describe(ST_CORRUPT, "%s: a frame has %lu bytes, expected %lu", path,
                               (unsigned long)expected, (unsigned long)size);
    if (r->j2k)
        return read_j2k(r, pixels, frame, buffer);
    OFString colours;
    const Uint32 from = r->fragment = frame == r->next ? r->fragment : 0;
    r->next = frame + 1;
    done = pixels->getUncompressedFrame(set, frame, r->fragment, buffer, (Uint32)(size + size % 2),
                                        colours);
    if (done.bad())
        return failed(path, "decoding its pixels", done);
    forget_fragments(pixels, from, r->fragment);
    if (r->samples == 3 && colours != "RGB")
        return status_describe(ST_UNSUPPORTED, "%s: colours as %s are not read", path,
                               colours.c_str());
    if (r->planar)
        interleave(buffer, size);
    if (r->halves)
        exchange_halves(buffer, size);
    return ST_OK;
}

} // namespace

void dicom_image_begin(void) {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    dcmEnableUnknownVRConversion.set(OFTrue); /* keep elements of a type that copying programs did
                                                 not know */
    DcmRLEDecoderRegistration::registerCodecs();
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
}

status dicom_image_read(const char *path, uint64_t bytes, dicom_image *out,
                        const dicom_places *places) {
    return guarded(path, [&]() -> status {
        DcmFileFormat file;
        memset(out, 0, sizeof *out);
        const OFCondition done = file.loadFileUntilTag(path, EXS_Unknown, EGL_noChange, 4096,
                                                       ERM_autoDetect, DCM_PixelData);
        if (done.bad())
            return failed(path, "reading its header", done);
        read_image(file, bytes, out);
        if (out->refuse[0])
            return ST_OK;
        return out->segments ? tell_labels(file.getDataset(), path, *out, places)
                             : tell_places(file.getDataset(), out->frames, places);
    });
}

status dicom_reader_open(const char *path, dicom_reader **out) {
    return guarded(path, [&]() -> status {
        dicom_reader *r =
            new dicom_reader{path, DcmFileFormat(), 0, 0, 1, false, false, false, {}, {}, {}};
        *out = r;
        const OFCondition done = r->file.loadFile(path, EXS_Unknown, EGL_noChange, 4096);
        if (done.bad())
            return failed(path, "reading it", done);
        DcmDataset *set = r->file.getDataset();
        r->samples = get_short(set, DCM_SamplesPerPixel, 1);
        r->planar = r->samples == 3 && get_short(set, DCM_PlanarConfiguration, 0) == 1;
        r->halves = set->getOriginalXfer() == EXS_BigEndianExplicit &&
                    get_short(set, DCM_BitsAllocated, 16) == 32;
        r->j2k = is_j2k(set->getOriginalXfer());
        read_numbers(set, &r->image);
        if (r->image.segments)
            return find_labels(set, path, r->image, r->labels);
        if (r->j2k) {
            const dicom_image &image = r->image;
            r->form = {image.columns,   image.rows,   image.samples,
                       image.allocated, image.stored, image.is_signed};
            return check_colours(set, path, image.samples);
        }
        return ST_OK;
    });
}

void dicom_reader_close(dicom_reader *r) {
    delete r;
}

status dicom_reader_overlaps(dicom_reader *r, uint64_t *pixels) {
    return guarded(r->path.c_str(), [&]() -> status {
        const uint8_t *bits = nullptr;
        status st = find_bits(r, &bits);
        std::vector<uint16_t> numbers((size_t)r->image.rows * r->image.columns);
        *pixels = 0;
        for (size_t i = 0; i < r->labels.size() && st == ST_OK; i++) {
            if (i > 0 && r->labels[i].group == r->labels[i - 1].group)
                continue;
            std::fill(numbers.begin(), numbers.end(), (uint16_t)0);
            *pixels += put_group(r, bits, &r->labels[i], numbers.data());
        }
        return st;
    });
}

status dicom_reader_frame(dicom_reader *r, uint32_t frame, void *buffer, size_t size) {
    return guarded(r->path.c_str(), [&]() { return read_frame(r, frame, buffer, size); });
}
